#include "gi/lighting/dirty_region.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lambent {

namespace {

/// Offsets of ray ends off their surfaces and rounding, many times over.
Aabb grown(Aabb box, float margin) {
  margin += 1e-4f * glm::max(maxComponent(glm::abs(box.lo)), maxComponent(glm::abs(box.hi)));
  box.lo -= margin;
  box.hi += margin;
  return box;
}

std::vector<Aabb> placesOf(const SceneView& view) {
  std::vector<Aabb> boxes;
  for (const InstanceView& i : view.instances) {
    if (!i.moved) continue;
    Aabb both = i.boundsWorld;
    both.add(i.boundsWorldBefore);
    // Between two frames an object mostly moves by less than its size: one box then does for both places.
    const auto volume = [](const Aabb& b) { return b.size().x * b.size().y * b.size().z; };
    if (volume(both) <= 1.5f * (volume(i.boundsWorld) + volume(i.boundsWorldBefore))) {
      boxes.push_back(both);
    } else {
      boxes.push_back(i.boundsWorld);
      boxes.push_back(i.boundsWorldBefore);
    }
  }
  boxes.insert(boxes.end(), view.addedOrRemoved.begin(), view.addedOrRemoved.end());
  return boxes;
}

} // namespace

const DirtyRegion kNothingMoved;

bool crosses(const Ray& ray, const Aabb& box) {
  float enter = 0, leave = ray.tMax;
  for (int a = 0; a < 3; ++a) {
    if (std::abs(ray.direction[a]) < 1e-30f) {
      if (ray.origin[a] < box.lo[a] || ray.origin[a] > box.hi[a]) return false;
      continue;
    }
    float t0 = (box.lo[a] - ray.origin[a]) / ray.direction[a], t1 = (box.hi[a] - ray.origin[a]) / ray.direction[a];
    if (t0 > t1) std::swap(t0, t1);
    enter = std::max(enter, t0);
    leave = std::min(leave, t1);
  }
  return enter <= leave;
}

DirtyRegion::DirtyRegion(std::span<const Aabb> boxes, float margin) {
  for (const Aabb& b : boxes)
    if (!b.empty()) boxes_.push_back(grown(b, margin));
  if (!boxes_.empty()) build(0, uint32_t(boxes_.size()));
}

DirtyRegion::DirtyRegion(const SceneView& view) : DirtyRegion(placesOf(view), 1e-4f * view.boundsWorld.diameter()) {}

void DirtyRegion::build(uint32_t first, uint32_t count) {
  constexpr uint32_t kLeaf = 4;
  const size_t index = nodes_.size();
  nodes_.emplace_back();
  for (uint32_t i = first; i < first + count; ++i) nodes_[index].box.add(boxes_[i]);
  if (count <= kLeaf) {
    nodes_[index].first = first;
    nodes_[index].count = count;
    return;
  }
  const vec3 size = nodes_[index].box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto begin = boxes_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [axis](const Aabb& a, const Aabb& b) { return a.lo[axis] + a.hi[axis] < b.lo[axis] + b.hi[axis]; });
  build(first, count / 2);
  nodes_[index].first = uint32_t(nodes_.size());
  build(first + count / 2, count - count / 2);
}

template <class Test> bool DirtyRegion::any(const Test& test) const {
  if (nodes_.empty()) return false;
  std::array<uint32_t, 64> stack;
  size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!test(node.box)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = index + 1;
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i)
      if (test(boxes_[i])) return true;
  }
  return false;
}

bool DirtyRegion::touches(const Ray& ray) const {
  return any([&](const Aabb& box) { return crosses(ray, box); });
}

bool DirtyRegion::touches(const Aabb& box) const {
  return any([&](const Aabb& b) {
    return glm::all(glm::lessThanEqual(b.lo, box.hi)) && glm::all(glm::lessThanEqual(box.lo, b.hi));
  });
}

bool DirtyRegion::touches(const vec3& centre, float radius) const {
  return any([&](const Aabb& box) {
    const vec3 d = glm::max(glm::max(box.lo - centre, centre - box.hi), vec3(0));
    return glm::dot(d, d) <= radius * radius;
  });
}

} // namespace lambent
