// Small scenes made by hand: quads with a material each, one mesh and one instance per quad or group.
#pragma once

#include "engine/trace/embree_query.h"
#include "gi/lighting/light_set.h"
#include "tests/support/test.h"

namespace lambent::test {

// What an extraction says of a frame.
inline constexpr SceneChanges kStill{false, false, false, false, false},
    kCameraChanged{false, true, false, false, false}, kLightsChanged{false, false, true, false, false},
    kGeometryChanged{false, false, false, true, false}, kInstancesChanged{false, false, false, false, true};

/// Owns what a SceneView points to.
class HandScene {
 public:
  HandScene() = default;
  HandScene(const HandScene&) = delete;

  uint32_t material(const vec3& albedo, const vec3& emission = vec3(0), bool doubleSided = false);
  uint32_t glossyMaterial(const vec3& albedo, float roughness, float metalness);
  /// Of a texture whose left half is cut out, the right one green.
  uint32_t lattice();
  /// To be looked up without filtering.
  TextureRef texture(int width, std::vector<u8vec4> texels, bool srgb = true);

  /// Gives a material a normal map of one texel, of the local direction; quads that are added later have tangents along
  /// their u.
  void normalMap(uint32_t materialIndex, const vec3& local);
  bool normalMapped() const;
  /// Parallelogram with front side cross(e1, e2); returns the instance.
  uint32_t quad(const vec3& corner, const vec3& e1, const vec3& e2, uint32_t materialIndex);
  /// Box seen from inside when `inward`: the front sides face in. One quad (instance) per face.
  void box(const vec3& lo, const vec3& hi, uint32_t materialIndex, bool inward);
  uint32_t add(Mesh mesh, const mat4& worldFromObject = mat4(1));
  uint32_t instance(uint32_t mesh, const mat4& worldFromObject);

  /// As an extraction tells of one that moved.
  void place(uint32_t index, const mat4& worldFromObject);
  /// All from `first` up to `end` go by `by`; the others stay.
  void move(uint32_t first, const vec3& by, uint32_t end = kNone);
  /// The whole scene is turned before it is first seen.
  void turn(const mat4& turned);
  /// Gives the instance vertices of its own; normals are the means of the triangles around them.
  void reshape(uint32_t index, std::vector<vec3> positions);

  LightView& lamp(const vec3& position, const vec3& intensity = vec3(1));
  void size(int width, int height) { camera.width = width, camera.height = height; }

  SceneView view(const SceneChanges& changes = {}) const;

  SceneAssets assets;
  std::vector<InstanceView> instances;
  std::vector<LightView> lights;
  Sky sky;
  CameraView camera;

 private:
  uint64_t lastRevision_ = 0;
};

/// A sheet of n × n quads over [-1,1]² at z = 0, front +z.
Mesh sheet(uint32_t n, uint32_t material);
/// A closed box around the origin, front sides out, each face with vertices of its own.
Mesh block(const vec3& halfSize, uint32_t material);
/// The sheet's vertices with waves of `height` across them, and `phase` along these, radians.
std::vector<vec3> waves(const Mesh& sheet, float height, float phase);

/// Camera at `eye` looking at `target`, +Y up.
CameraView cameraAt(const vec3& eye, const vec3& target, float fovY, int width = 64, int height = 48);
/// Through the middle of a pixel, y from the top.
inline CameraRay pixelRay(const CameraView& camera, int x, int y) {
  return cameraRay(camera, (float(x) + 0.5f) / float(camera.width), (float(y) + 0.5f) / float(camera.height));
}

/// All that a query says of rays.
struct Answers {
  std::vector<SurfaceHit> hits;
  std::vector<float> distances;
  std::vector<uint8_t> blocked;

  Answers(const RayQuery& query, std::span<const Ray> rays)
      : hits(rays.size()), distances(rays.size()), blocked(rays.size()) {
    query.closest(rays, hits);
    query.distances(rays, distances);
    query.occluded(rays, blocked);
  }
  auto free() const { return std::ranges::count(blocked, 0); }
};

/// As rays and light paths see it, when nothing moves.
struct TracedScene {
  SceneView view;
  EmbreeQuery rays;
  LightSet lights;

  explicit TracedScene(const HandScene& scene) : view(scene.view()), rays(scene.assets), lights(collectLights(view)) {
    rays.update(view, true);
  }
};

} // namespace lambent::test
