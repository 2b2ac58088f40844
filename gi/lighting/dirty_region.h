// Where the geometry changed since the last frame: boxes around the old and the new place of every object that moved.
// What none of them touches is as it was; caches of rays test their segments against them.
#pragma once

#include "engine/trace/ray_query.h"

#include <vector>

namespace lambent {

/// A set of boxes in a tree. World space, metres. Boxes are grown a little, so that a ray that ends on a surface inside
/// one touches it for certain.
class DirtyRegion {
 public:
  DirtyRegion() = default;                                                 // nothing moved
  explicit DirtyRegion(std::span<const Aabb> boxes, float margin = 1e-3f); // metres, beyond float steps
  /// Holds the old and new bounds of the instances that moved.
  explicit DirtyRegion(const SceneView& view);

  bool empty() const { return nodes_.empty(); }
  bool touches(const Ray& ray) const; // tMax may be infinite
  bool touches(const vec3& centre, float radius) const;
  bool touches(const Aabb& box) const;
  std::span<const Aabb> boxes() const { return boxes_; }

 private:
  struct Node {
    Aabb box;
    uint32_t first = 0, count = 0; // run of boxes_ in a leaf; count = 0: children at index + 1 and at `first`
  };
  void build(uint32_t first, uint32_t count);
  template <class Test> bool any(const Test& test) const;

  std::vector<Aabb> boxes_;
  std::vector<Node> nodes_;
};

/// The empty region: nothing moved.
extern const DirtyRegion kNothingMoved;

/// Says whether the ray passes through the box within its tMax.
bool crosses(const Ray& ray, const Aabb& box);

} // namespace lambent
