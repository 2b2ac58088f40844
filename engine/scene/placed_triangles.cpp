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

constexpr size_t kRigidInGroup = 64;

/// Along a curve through a box: what follows one another lies beside one another. `middleOf(i)` lies in it.
template <class MiddleOf>
std::vector<uint32_t> orderAlongCurve(const Aabb& box, size_t count, const MiddleOf& middleOf) {
  constexpr float kCells = 1023; // along each side
  const vec3 size = glm::max(box.size(), vec3(1e-30f));
  std::vector<uint64_t> keys(count); // place on the curve, then number
  for (size_t i = 0; i < count; ++i) {
    const vec3 at = glm::min(glm::max(vec3(0), (middleOf(i) - box.lo) / size), vec3(1));
    keys[i] = uint64_t(alongCurve(uvec3(kCells * at))) << 32 | i;
  }
  std::ranges::sort(keys);
  std::vector<uint32_t> order;
  for (const uint64_t key : keys) order.push_back(uint32_t(key));
  return order;
}

std::vector<uint32_t> orderOf(const Mesh& mesh) {
  return orderAlongCurve(mesh.boundsObject, mesh.triangles.size(), [&](size_t i) {
    const uvec3& t = mesh.triangles[i];
    return (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
  });
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

PlacedTriangles::PlacedTriangles(const Scene& scene) : scene_(scene) {
  Aabb all;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    if (mesh.triangles.empty()) return;
    deforms_ |= deformed != nullptr;
    if (deformed) return;
    rigid_.push_back({&mesh, worldFromObject, transformed(mesh.boundsObject, worldFromObject)});
    all.add(rigid_.back().box.centre());
  });
  std::vector<Rigid> sorted;
  sorted.reserve(rigid_.size());
  for (const uint32_t i : orderAlongCurve(all, rigid_.size(), [&](size_t i) { return rigid_[i].box.centre(); }))
    sorted.push_back(rigid_[i]);
  rigid_ = std::move(sorted);
  groups_.resize((rigid_.size() + kRigidInGroup - 1) / kRigidInGroup);
  for (size_t i = 0; i < rigid_.size(); ++i) groups_[i / kRigidInGroup].add(rigid_[i].box);
}

void PlacedTriangles::visitInstance(const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject,
                                    const std::function<bool(const Aabb&)>& wanted,
                                    const std::function<void(const TriangleBlock&)>& visit) {
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
}

void PlacedTriangles::forEachBlock(const std::function<bool(const Aabb&)>& wanted,
                                   const std::function<void(const TriangleBlock&)>& visit) {
  for (size_t group = 0; group < groups_.size(); ++group) {
    if (!wanted(groups_[group])) continue;
    const size_t end = std::min((group + 1) * kRigidInGroup, rigid_.size());
    for (size_t i = group * kRigidInGroup; i < end; ++i)
      if (const Rigid& r = rigid_[i]; wanted(r.box)) visitInstance(*r.mesh, nullptr, r.worldFromObject, wanted, visit);
  }
  if (!deforms_) return;
  forEachPosed(scene_, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    if (deformed && !mesh.triangles.empty() && wanted(transformed(deformed->boundsObject, worldFromObject)))
      visitInstance(mesh, deformed, worldFromObject, wanted, visit);
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
