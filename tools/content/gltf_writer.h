// Collects a scene and writes it as glTF 2.0: one JSON file, one buffer, PNG textures. Only what the generated scenes
// use. Order of files, keys and numbers is fixed, so equal scenes give equal bytes.
#pragma once

#include "tools/content/content.h"
#include "tools/content/shapes.h"

#include <nlohmann/json.hpp>

#include <optional>

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
  double roughness = 1, metalness = 0;
  Index roughnessMetalnessTexture = kAbsent; // roughness in green, metalness in blue, times the two above
  bool alphaMask = false;
  bool doubleSided = false;
  dvec3 emissionColor{0};      // each channel in [0, 1]
  double emissionRadiance = 0; // W/(m² sr) where the colour is 1
};

struct NodeSpec {
  std::string name;
  dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  Index mesh = kAbsent, camera = kAbsent, light = kAbsent;
};

/// Rotation that turns -Z, the axis of glTF cameras and lights, into `direction`.
glm::dquat facing(const dvec3& direction);

class GltfWriter {
 public:
  Index addTexture(Texture texture);
  Index addMaterial(const MaterialSpec& material);
  Index addMesh(const std::string& name, const Geometry& geometry, Index material);
  /// A mesh that shares the geometry of `mesh` under another material.
  Index addMeshVariant(const std::string& name, Index mesh, Index material);
  Index addPerspectiveCamera(const std::string& name, double fovYDegrees);
  Index addDirectionalLight(const std::string& name, const dvec3& color, double irradiance);
  Index addPointLight(const std::string& name, const dvec3& color, double intensity);
  /// Full intensity within `innerDegrees` of the axis and none beyond `outerDegrees`: half of the cone's opening each.
  Index addSpotLight(const std::string& name, const dvec3& color, double intensity, double innerDegrees,
                     double outerDegrees);
  Index addNode(const NodeSpec& node);
  /// Adds a linear channel to the scene's one animation clip; times in seconds, ascending.
  void animateTranslation(Index node, const std::vector<double>& times, const std::vector<dvec3>& translations);

  /// Writes `stem`.gltf, `stem`.bin and the textures.
  GeneratedScene write(const std::filesystem::path& folder, const std::string& stem) const;

 private:
  enum class Target { None, Vertices, Indices };
  /// Appends floats (or indices, 16-bit where they fit) to the buffer and describes them; gives the accessor.
  Index addAccessor(const std::vector<float>& values, uint32_t components, Target target, bool bounds);
  Index addIndexAccessor(const std::vector<uint32_t>& indices);
  Index addView(const void* data, size_t bytes, Target target);
  Index addLight(const std::string& name, const char* type, const dvec3& color, double intensity);

  nlohmann::json accessors_ = nlohmann::json::array(), views_ = nlohmann::json::array();
  nlohmann::json materials_ = nlohmann::json::array(), meshes_ = nlohmann::json::array();
  nlohmann::json nodes_ = nlohmann::json::array(), cameras_ = nlohmann::json::array();
  nlohmann::json lights_ = nlohmann::json::array();
  nlohmann::json channels_ = nlohmann::json::array(), samplers_ = nlohmann::json::array();
  std::vector<Texture> textures_;
  std::vector<uint64_t> meshTriangles_;
  std::vector<uint8_t> buffer_;
  uint64_t placedTriangles_ = 0;
  bool emissiveStrength_ = false;
};

} // namespace lambent::content
