// Paper 1, 3.2.4: density of VPLs on the surface by k nearest neighbours in 3D. In place of the density p = k/(N π
// r_k²) we keep the area that the point stands for, a = 1/(N p) = π r_k²/k, because N cancels in the rendering sum.
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "gi/vpl/smc.h"

#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

struct Cloud {
  std::span<const DensityPoint> points;
  size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(size_t i, size_t axis) const { return points[i].position[int(axis)]; }
  template <class Box> bool kdtree_get_bbox(Box&) const { return false; }
};

} // namespace

struct NeighbourTree::Tree {
  Cloud cloud;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, uint32_t> index;
  explicit Tree(std::span<const DensityPoint> among)
      : cloud{among}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {}
};

NeighbourTree::NeighbourTree(std::span<const DensityPoint> among) {
  for (const DensityPoint& p : among) CHECK(isFinite(p.position)); // a NaN silently spoils other answers in nanoflann
  if (!among.empty()) tree_ = std::make_unique<Tree>(among);
}
NeighbourTree::~NeighbourTree() = default;

size_t NeighbourTree::nearest(const vec3& position, size_t count, std::span<uint32_t> index,
                              std::span<float> distance2) const {
  return tree_ ? tree_->index.knnSearch(&position.x, count, index.data(), distance2.data()) : 0;
}

std::span<const uint32_t> NeighbourTree::order() const {
  return tree_ ? std::span<const uint32_t>(tree_->index.vAcc) : std::span<const uint32_t>();
}

std::vector<float> representedAreas(std::span<const DensityPoint> queries, std::span<const DensityPoint> among,
                                    bool self, int k, DensityEstimator estimator, float areaLimit) {
  CHECK(k >= 1);
  std::vector<float> areas(queries.size(), areaLimit);
  if (among.empty()) return areas;
  if (self) CHECK_EQ(queries.size(), among.size());
  const NeighbourTree tree(among);
  const bool oneSide = estimator != DensityEstimator::Knn;

  // Neighbours on the other side of a wall are passed over, so look at some more than k.
  const size_t wanted = size_t(k) + (self ? 1 : 0) + (oneSide ? 8 : 0);
  // Points of the tree query it in its own order, so that neighbours in time are neighbours in space (1.6 times as fast
  // for 33 k points).
  const std::span<const uint32_t> order = self ? tree.order() : std::span<const uint32_t>();
  parallelFor(queries.size(), 128, [&](size_t begin, size_t end) {
    std::vector<uint32_t> index(wanted);
    std::vector<float> distance2(wanted);
    for (size_t n = begin; n < end; ++n) {
      const size_t i = order.empty() ? n : order[n];
      if (!isFinite(queries[i].position)) continue;
      size_t found = 0;
      int seen = 0;
      float kth = 0;
      // Mostly the nearest are on this side: few are asked for first, which takes half the time.
      for (const size_t asked : {std::min(wanted, size_t(k) + (self ? 2 : 1)), wanted}) {
        found = tree.nearest(queries[i].position, asked, index, distance2);
        seen = 0;
        for (size_t j = 0; j < found && seen < k; ++j) {
          if (self && index[j] == i) continue;
          if (oneSide && !sameSide(queries[i].normal, among[index[j]].normal)) continue;
          kth = distance2[j];
          ++seen;
        }
        if (seen == k) break;
      }
      if (seen == 0) { // nobody on this side near by: at least as far as the last one looked at
        if (found <= size_t(self)) continue;
        kth = distance2[found - 1];
        seen = 1;
      }
      areas[i] = std::min(areaLimit, kPi * kth / float(seen)) * queries[i].share;
    }
  });
  return areas;
}

int neighboursForRendering(const SmcSettings& settings) {
  if (settings.neighbours > 0) return settings.neighbours;
  return std::max(1, int(std::sqrt(float(settings.vpls) / 32)));
}

} // namespace lambent
