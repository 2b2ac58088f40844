// Hierarchies of boxes for ray tracers other than Embree, flattened (shaders/shared/ray_scene.h).
#pragma once

#include "engine/core/math.h"
#include "shaders/shared/ray_scene.h"

#include <memory>
#include <span>
#include <vector>

namespace lambent {

struct Bvh {
  std::vector<BvhNode> nodes;  // none without boxes
  std::vector<uint32_t> order; // the boxes' numbers, by leaf
};

/// Embree's builder (surface area heuristic).
class BvhBuilder {
 public:
  BvhBuilder();
  ~BvhBuilder();
  /// At most `leafSize` ≤ 7 boxes per leaf. Boxes that are empty or not finite are left out. Throws RunError where
  /// Embree fails.
  Bvh build(std::span<const Aabb> boxes, uint32_t leafSize) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Makes the hierarchy hold the boxes where they are now. It stays exact, but is slower to trace the farther they have
/// gone. `boxes` as for build.
void refit(Bvh& bvh, std::span<const Aabb> boxes);

} // namespace lambent
