// Paper 1, algorithm 1 line 5: places where a VPL could stand, by random rays from the visible points.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/vpl/smc.h"

#include <algorithm>

namespace lambent {

std::vector<CandidateHit> traceCandidates(const RayQuery& rays, std::span<const VisiblePoint> points, int count,
                                          uint32_t seed, uint32_t frame, RayCounts& counts) {
  if (points.empty() || count <= 0) return {};
  std::vector<SurfaceHit> hits(count);
  // Ray i leaves point ⌊i·P/count⌋, so each point sends the same number (±1) and neighbours in memory share an origin.
  const auto pointOf = [&](size_t i) { return points[size_t(uint64_t(i) * points.size() / uint64_t(count))]; };
  parallelFor(count, 256, [&](size_t begin, size_t end) {
    std::vector<Ray> block;
    for (size_t i = begin; i < end; ++i) {
      Rng rng(seed, Stream::Candidates, uint32_t(i), frame);
      const VisiblePoint x = pointOf(i);
      block.push_back({x.position, sampleCosineHemisphere(x.normal, rng.next2())});
    }
    rays.closest(block, std::span(hits).subspan(begin, end - begin));
  });
  counts.closest += count;

  std::vector<CandidateHit> out;
  out.reserve(count);
  for (size_t i = 0; i < hits.size(); ++i) {
    const SurfaceHit& h = hits[i];
    // Points that are not finite would corrupt the nearest-neighbour trees.
    if (h.valid() && isFinite(h.position) && isFinite(h.normal))
      out.push_back({h.position, h.normal, h.geometricNormal, h.albedo, pointOf(i).position, h.instance, h.primitive,
                     h.triangle, h.barycentric, h.share});
  }
  return out;
}

} // namespace lambent
