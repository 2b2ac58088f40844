// Collects a scene and writes it as glTF 2.0: one JSON file, one buffer, PNG textures. Only what the generated scenes
// use. Order of files, keys and numbers is fixed, so equal scenes give equal bytes.
#pragma once

#include "tools/content/content.h"
#include "tools/content/shapes.h"

#include <nlohmann/json_fwd.hpp> // all of it takes seconds to compile

namespace lambent::content {

/// Index into one of the glTF arrays.
using Index = uint32_t;
inline constexpr Index kAbsent = 0xffffffffu;

/// 8-bit RGBA texture, row 0 at v = 0.
struct Texture {
  std::string name; // file name without ending
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgba;
};

struct MaterialSpec {
  std::string name;
  dvec3 albedo{0.7};
  Index texture = kAbsent;
  double roughness = 1;
  Index roughnessMetalnessTexture = kAbsent; // roughness in green, times the one above
  bool alphaMask = false;
  bool doubleSided = false;
  dvec3 emissionColor{0};      // each channel in [0, 1]
  double emissionRadiance = 0; // W/(m² sr) where the colour is 1
};

/// Every large scene comes in two sizes of one plan: Full, 250 000 to 550 000 placed triangles (60 000 to 120 000 where
/// they are mostly thin sheets), and Small, at most 30 000, with fewer parts and coarser meshes, for tests.
enum class SceneSize { Full, Small };

/// A scene that is to be made: where its files go, how they are called, how large it is.
struct Order {
  std::filesystem::path folder;
  std::string name;
  SceneSize size = SceneSize::Full;
};

class SceneBuilder {
 public:
  explicit SceneBuilder(const Order& order);
  ~SceneBuilder();

  Index texture(Texture texture);
  Index material(const MaterialSpec& material);
  Index paint(const std::string& name, const dvec3& albedo, Index texture = kAbsent) {
    return material({.name = name, .albedo = albedo, .texture = texture});
  }
  Index fabric(const std::string& name, const dvec3& albedo) {
    return material({.name = name, .albedo = albedo, .doubleSided = true});
  }
  /// `radiance` in W/(m² sr) where the colour is 1.
  Index glowing(const std::string& name, const dvec3& color, double radiance, double albedo = 0.8) {
    return material({.name = name, .albedo = dvec3(albedo), .emissionColor = color, .emissionRadiance = radiance});
  }

  Index mesh(const std::string& name, const Geometry& geometry, Index material);
  /// A mesh that shares the geometry of `mesh` under another material.
  Index variant(const std::string& name, Index mesh, Index material);
  /// Places a mesh, turned around the vertical axis first (degrees, counter-clockwise from above).
  Index place(const std::string& name, Index mesh, const dvec3& at, double turn = 0);
  /// Places a mesh of its own.
  Index place(const std::string& name, const Geometry& geometry, Index material, const dvec3& at = dvec3(0));

  /// `intensity` in W/sr where the colour is 1.
  Index lamp(const std::string& name, const dvec3& color, double intensity, const dvec3& at);
  /// A spot with its full intensity within `innerDegrees` of its axis and none beyond `outerDegrees`: half of the
  /// cone's opening each. `intensity` as for `lamp`.
  Index spot(const std::string& name, const dvec3& color, double intensity, const dvec3& at, const dvec3& direction,
             double innerDegrees = 40, double outerDegrees = 45);
  /// `irradiance` in W/m² where the colour is 1; `height` is only where an editor shows it.
  void sun(const dvec3& direction, const dvec3& color, double irradiance, double height = 20,
           const std::string& name = "sun");
  void camera(const std::string& name, const dvec3& eye, const dvec3& target, double fovYDegrees = 60);

  /// Moves a node around a closed path, which gives the place at an angle from 0 to 2 pi, in `seconds`: a linear
  /// channel of the scene's one animation clip.
  void animate(Index node, double seconds, const std::function<dvec3(double)>& path);

  bool full() const { return order_.size == SceneSize::Full; }
  uint32_t detail(uint32_t full, uint32_t small) const { return this->full() ? full : small; }

  /// Writes NAME.gltf, NAME.bin and the textures.
  GeneratedScene write() const;

 private:
  struct Lists;
  /// Appends values to the buffer and describes them; gives the accessor.
  template <class T>
  Index accessor(const std::vector<T>& values, size_t components, uint32_t target = 0, bool bounds = false);
  Index addNode(const std::string& name, const dvec3& at, const glm::dquat& rotation, nlohmann::json what);
  Index addLight(const std::string& name, const char* type, const dvec3& color, double intensity, const dvec3& at,
                 const glm::dquat& rotation);

  Order order_;
  std::unique_ptr<Lists> lists_; // what the file will hold
  std::vector<Texture> textures_;
  std::vector<uint64_t> meshTriangles_;
  std::string buffer_;
  uint64_t placedTriangles_ = 0;
  bool emissiveStrength_ = false;
};

/// The sides of a plan that is alike on both.
struct Side {
  std::string name;
  double sign; // of z
  double turn; // takes what is made for the south side to this one, degrees
};
inline const std::array<Side, 2> kSides{{{"south", 1, 0}, {"north", -1, 180}}};

/// Uniform in [0, 1), a function of its arguments alone: stands in for chance, so that every run gives the same scene.
double hashed(uint32_t a, uint32_t b = 0);

} // namespace lambent::content
