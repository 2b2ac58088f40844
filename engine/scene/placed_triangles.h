// Triangles as they stand in the world, for questions that are asked of a scene once, when it is loaded.
#pragma once

#include "engine/scene/scene.h"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <unordered_map>

namespace lambent {

/// Some triangles of an instance that lie beside one another; valid while they are visited.
struct TriangleBlock {
  const Mesh& mesh;
  const DeformedMesh* deformed; // null: rigid
  const mat4& worldFromObject;
  std::span<const uint32_t> triangles; // of mesh.triangles
  Aabb box;                            // around them, world space; may be larger

  std::array<vec3, 3> corners(size_t triangle) const { // world space
    const std::vector<vec3>& positions = deformed ? deformed->positions : mesh.positions;
    std::array<vec3, 3> out;
    for (int c = 0; c < 3; ++c)
      out[size_t(c)] = vec3(worldFromObject * vec4(positions[mesh.triangles[triangle][c]], 1));
    return out;
  }
};

/// A scene's triangles in blocks, as it is when it is made. Keeps boxes of each mesh, so that a mesh that is shown
/// often is looked at where it is asked for only, and costs neither time nor memory for each of its triangles in each
/// place. Blocks follow a curve through space, whatever the order in the file, and so do instances: many of them are
/// asked for at once.
class PlacedTriangles {
 public:
  explicit PlacedTriangles(const Scene& scene);

  /// Calls `visit` for all blocks whose box is `wanted`, each just after it was asked for; of instances whose box is
  /// not, none.
  void forEachBlock(const std::function<bool(const Aabb&)>& wanted,
                    const std::function<void(const TriangleBlock&)>& visit);

 private:
  struct Blocks {
    std::vector<uint32_t> order; // triangles, block after block
    std::vector<Aabb> boxes;     // of blocks, object space, undeformed
  };
  const Blocks& blocksOf(const Mesh& mesh);

  struct Rigid {
    const Mesh* mesh;
    mat4 worldFromObject;
    Aabb box; // world space
  };
  void visitInstance(const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject,
                     const std::function<bool(const Aabb&)>& wanted,
                     const std::function<void(const TriangleBlock&)>& visit);

  const Scene& scene_;
  std::vector<Rigid> rigid_; // along a curve through space
  std::vector<Aabb> groups_; // around so many of them
  bool deforms_ = false;
  std::unordered_map<const Mesh*, Blocks> blocks_;
};

/// Where a line is in a box first between `from` and `to`, in units of its direction; nothing where it passes it by.
std::optional<float> entry(const Aabb& box, const vec3& origin, const vec3& direction, float from, float to);

} // namespace lambent
