#include "engine/scene/placed_triangles.h"

#include "engine/core/sampling.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr size_t kTrianglesInBlock = 32;

std::vector<Aabb> boxesOf(const Mesh& mesh, std::span<const uint32_t> order, const std::vector<vec3>& positions) {
  std::vector<Aabb> boxes((order.size() + kTrianglesInBlock - 1) / kTrianglesInBlock);
  for (size_t i = 0; i < order.size(); ++i)
    for (int c = 0; c < 3; ++c) boxes[i / kTrianglesInBlock].add(positions[mesh.triangles[order[i]][c]]);
  return boxes;
}

/// Along a curve through the mesh's box: what follows one another lies beside one another.
std::vector<uint32_t> orderOf(const Mesh& mesh) {
  constexpr float kCells = 1023; // along each side
  const vec3 size = glm::max(mesh.boundsObject.size(), vec3(1e-30f));
  std::vector<uint64_t> keys(mesh.triangles.size()); // place on the curve, then number
  for (size_t i = 0; i < keys.size(); ++i) {
    const uvec3& t = mesh.triangles[i];
    const vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
    const vec3 at = glm::clamp((middle - mesh.boundsObject.lo) / size, 0.0f, 1.0f);
    keys[i] = uint64_t(alongCurve(uvec3(kCells * at))) << 32 | i;
  }
  std::ranges::sort(keys);
  std::vector<uint32_t> order;
  for (const uint64_t key : keys) order.push_back(uint32_t(key));
  return order;
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
    const Blocks& blocks = blocksOf(mesh);
    const std::span<const uint32_t> order = blocks.order;
    std::vector<Aabb> boxesOfDeformed;
    if (deformed) boxesOfDeformed = boxesOf(mesh, order, deformed->positions);
    const std::vector<Aabb>& boxes = deformed ? boxesOfDeformed : blocks.boxes;
    for (size_t i = 0; i < boxes.size(); ++i) {
      const size_t begin = i * kTrianglesInBlock, count = std::min(kTrianglesInBlock, order.size() - begin);
      const Aabb box = transformed(boxes[i], worldFromObject);
      if (wanted(box)) visit({mesh, deformed, worldFromObject, order.subspan(begin, count), box});
    }
  });
}

const PlacedTriangles::Blocks& PlacedTriangles::blocksOf(const Mesh& mesh) {
  Blocks& blocks = blocks_[&mesh];
  if (blocks.order.empty()) {
    blocks.order = orderOf(mesh);
    blocks.boxes = boxesOf(mesh, blocks.order, mesh.positions);
  }
  return blocks;
}

} // namespace lambent
