// Paper 1, algorithm 1 line 3: points on the surfaces that the camera sees, by rays from the camera.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "gi/vpl/smc.h"
#include "shaders/shared/coverage.h"

#include <algorithm>
#include <cmath>

namespace lambent {

std::vector<VisiblePoint> findVisiblePoints(const RayQuery& rays, const CameraView& camera, int count, uint32_t seed,
                                            uint32_t frame, RayCounts& counts) {
  const int columns = std::max(1, int(std::lround(std::sqrt(count * camera.aspect()))));
  const int rows = std::max(1, (count + columns - 1) / columns);
  const size_t cells = size_t(columns) * rows;
  std::vector<SurfaceHit> hits(cells);
  parallelFor(cells, 256, [&](size_t begin, size_t end) {
    std::vector<Ray> block;
    for (size_t i = begin; i < end; ++i) {
      Rng rng(seed, Stream::VisiblePoints, uint32_t(i), frame);
      const vec2 jitter = rng.next2();
      const CameraRay r =
          cameraRay(camera, (float(i % columns) + jitter.x) / columns, (float(i / columns) + jitter.y) / rows);
      block.push_back({r.origin, r.direction, kInfinity, camera.throughBlended ? kMeetsNone : 0});
    }
    rays.seen(block, std::span(hits).subspan(begin, end - begin));
  });
  counts.closest += cells;

  std::vector<VisiblePoint> points;
  points.reserve(cells);
  for (const SurfaceHit& h : hits)
    if (h.valid() && isFinite(h.position))
      points.push_back({offsetPoint(h.position, h.geometricNormal, rays.rayEpsilon()), h.geometricNormal});
  return points;
}

} // namespace lambent
