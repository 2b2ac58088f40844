// Paper 1, 3.2.1: weighted resampling without replacement, so that candidates are uniform over the indirectly visible
// area however the hits crowd. The paper draws in parallel with atomics; 2048 binary searches in order cost 0.1 ms and
// are deterministic.
#include "engine/core/rng.h"
#include "gi/vpl/smc.h"

#include <algorithm>

namespace lambent {

Resampled resampleUniformInArea(std::span<const CandidateHit> hits, int count, uint32_t seed, uint32_t frame) {
  if (hits.empty()) return {};
  std::vector<DensityPoint> points;
  points.reserve(hits.size());
  for (const CandidateHit& h : hits) points.push_back({h.position, h.normal});
  // k = 1, as the paper has it for candidates: π r² to the nearest other hit is an unbiased, if noisy, share of area.
  std::vector<float> areas = representedAreas(points, points, true, 1, DensityEstimator::Knn, kInfinity);
  if (hits.size() == 1) { // no neighbour shows it; what it is seen from must not be nearer than its rim
    const vec3 d = hits[0].position - hits[0].from;
    areas[0] = kPi * glm::dot(d, d);
  }
  const Distribution distribution(areas);

  constexpr int kRetries = 8;
  Resampled out;
  out.area = distribution.total();
  std::vector<uint8_t> taken(hits.size(), 0);
  for (int i = 0; i < count && out.picks.size() < hits.size(); ++i) {
    Rng rng(seed, Stream::Resample, uint32_t(i), frame);
    for (int attempt = 0; attempt <= kRetries; ++attempt) {
      // All hits in one place: no area to tell them apart.
      const uint32_t pick = distribution.empty() ? rng.below(uint32_t(hits.size())) : distribution.sample(rng.next());
      if (taken[pick]) continue;
      taken[pick] = 1;
      out.picks.push_back(pick);
      break;
    }
  }
  return out;
}

} // namespace lambent
