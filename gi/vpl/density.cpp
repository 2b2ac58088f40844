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
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, uint32_t>;

} // namespace

std::vector<float> representedAreas(std::span<const DensityPoint> queries, std::span<const DensityPoint> among,
                                    bool self, int k, DensityEstimator estimator, float areaLimit) {
  CHECK(k >= 1);
  std::vector<float> areas(queries.size(), areaLimit);
  if (among.empty()) return areas;
  if (self) CHECK_EQ(queries.size(), among.size());
  for (const DensityPoint& p : among) CHECK(isFinite(p.position)); // a NaN silently spoils other answers in nanoflann
  const Cloud cloud{among};
  const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));

  // Neighbours on the other side of a wall are passed over, so look at some more than k.
  const size_t wanted = size_t(k) + (self ? 1 : 0) + (estimator == DensityEstimator::KnnSide ? 8 : 0);
  // Points of the tree query it in its own order, so that neighbours in time are neighbours in space (1.6 times as fast
  // for 33 k points).
  const bool treeOrder = self && tree.vAcc.size() == queries.size();
  parallelFor(queries.size(), 128, [&](size_t begin, size_t end) {
    std::vector<uint32_t> index(wanted);
    std::vector<float> distance2(wanted);
    for (size_t n = begin; n < end; ++n) {
      const size_t i = treeOrder ? tree.vAcc[n] : n;
      if (!isFinite(queries[i].position)) continue;
      const size_t found = tree.knnSearch(&queries[i].position.x, wanted, index.data(), distance2.data());
      int seen = 0;
      float kth = 0;
      for (size_t j = 0; j < found && seen < k; ++j) {
        if (self && index[j] == i) continue;
        if (estimator == DensityEstimator::KnnSide && !sameSide(queries[i].normal, among[index[j]].normal)) continue;
        kth = distance2[j];
        ++seen;
      }
      if (seen == 0) { // nobody on this side near by: at least as far as the last one looked at
        if (found <= size_t(self)) continue;
        kth = distance2[found - 1];
        seen = 1;
      }
      areas[i] = std::min(areaLimit, kPi * kth / float(seen));
    }
  });
  return areas;
}

int neighboursForRendering(const SmcSettings& settings) {
  if (settings.neighbours > 0) return settings.neighbours;
  return std::max(1, int(std::sqrt(float(settings.vpls) / 32)));
}

} // namespace lambent
