#include "engine/scene/placed_triangles.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr size_t kTrianglesInBlock = 32;

std::vector<Aabb> boxesOf(const Mesh& mesh, const std::vector<vec3>& positions) {
  std::vector<Aabb> boxes((mesh.triangles.size() + kTrianglesInBlock - 1) / kTrianglesInBlock);
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int c = 0; c < 3; ++c) boxes[i / kTrianglesInBlock].add(positions[mesh.triangles[i][c]]);
  return boxes;
}

} // namespace

std::optional<float> entry(const Aabb& box, const vec3& origin, const vec3& direction, float from, float to) {
  for (int axis = 0; axis < 3; ++axis) {
    const float o = origin[axis], d = direction[axis];
    if (d == 0 && (o < box.lo[axis] || o > box.hi[axis])) return {};
    if (d == 0) continue;
    const float a = (box.lo[axis] - o) / d, b = (box.hi[axis] - o) / d;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to ? std::optional(from) : std::nullopt;
}

void PlacedTriangles::forEachBlock(const std::function<bool(const Aabb&)>& wanted,
                                   const std::function<void(const TriangleBlock&)>& visit) {
  forEachPosed(scene_, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    if (mesh.triangles.empty()) return;
    if (!wanted(transformed(deformed ? deformed->boundsObject : mesh.boundsObject, worldFromObject))) return;
    std::vector<Aabb> boxesOfDeformed;
    if (deformed) boxesOfDeformed = boxesOf(mesh, deformed->positions);
    std::vector<Aabb>& boxes = deformed ? boxesOfDeformed : boxesOfRigid_[&mesh];
    if (boxes.empty()) boxes = boxesOf(mesh, mesh.positions);
    for (size_t i = 0; i < boxes.size(); ++i) {
      const size_t begin = i * kTrianglesInBlock, end = std::min(begin + kTrianglesInBlock, mesh.triangles.size());
      const Aabb box = transformed(boxes[i], worldFromObject);
      if (wanted(box)) visit({mesh, deformed, worldFromObject, begin, end, box});
    }
  });
}

} // namespace lambent
