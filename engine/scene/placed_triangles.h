// Triangles as they stand in the world, for questions that are asked of a scene once, when it is loaded.
#pragma once

#include "engine/core/rng.h"
#include "engine/scene/scene.h"

#include <array>
#include <functional>
#include <optional>
#include <unordered_map>

namespace lambent {

/// Some triangles that follow one another in an instance's mesh; valid while they are visited.
struct TriangleBlock {
  const Mesh& mesh;
  const DeformedMesh* deformed; // null: rigid
  const mat4& worldFromObject;
  size_t begin, end; // of mesh.triangles
  Aabb box;          // around them, world space; may be larger

  std::array<vec3, 3> corners(size_t triangle) const { // world space
    const std::vector<vec3>& positions = deformed ? deformed->positions : mesh.positions;
    std::array<vec3, 3> out;
    for (int c = 0; c < 3; ++c)
      out[size_t(c)] = vec3(worldFromObject * vec4(positions[mesh.triangles[triangle][c]], 1));
    return out;
  }
};

/// A scene's triangles in blocks. Keeps boxes of each mesh, so that a mesh that is shown often is looked at where it is
/// asked for only, and costs neither time nor memory for each of its triangles in each place.
class PlacedTriangles {
 public:
  explicit PlacedTriangles(const Scene& scene) : scene_(scene) {}

  /// Calls `visit` for all blocks whose box is `wanted`, each just after it was asked for; of instances whose box is
  /// not, none. In the order of instances and their triangles.
  void forEachBlock(const std::function<bool(const Aabb&)>& wanted,
                    const std::function<void(const TriangleBlock&)>& visit);

 private:
  const Scene& scene_;
  std::unordered_map<const Mesh*, std::vector<Aabb>> boxesOfRigid_; // object space
};

/// Where a line enters a box between `from` and `to`, in units of its direction; nothing where it passes it by.
std::optional<float> entry(const Aabb& box, const vec3& origin, const vec3& direction, float from, float to);

/// Uniform integer in [0, n), n > 0.
inline uint64_t drawnBelow(uint64_t n, Rng& random) {
  const uint64_t high = random.nextUint();
  return (high << 32 | random.nextUint()) % n;
}

} // namespace lambent
