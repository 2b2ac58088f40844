#include "gi/measure/watched.h"

#include "engine/core/error.h"
#include "gi/vpl/smc.h"

#include <algorithm>

namespace lambent {

TrackedPixels trackedPixels(const Shot& shot, int grid) {
  TrackedPixels tracked{shot.pixels, shot.pixels.size()};
  for (int y = 0; y < grid; ++y)
    for (int x = 0; x < grid; ++x) tracked.points.push_back((vec2(x, y) + 0.5f) / float(grid));
  return tracked;
}

TrackedValue trackedValue(const PixelSums& sums, const SurfaceHit& surface, uint32_t samples, bool direct) {
  if (!surface.valid()) return {};
  const double n = samples;
  const glm::dvec3 mean = (direct ? sums.direct : sums.indirect) / n;
  const glm::dvec3 squares = (direct ? sums.directSquares : sums.indirectSquares) / n;
  const glm::dvec3 variance = glm::max(glm::dvec3(0), squares - mean * mean) / std::max(1.0, n - 1);
  const vec3 emitted = direct ? surface.emission : vec3(0);
  return {surface.albedo * vec3(mean) + emitted, surface.albedo * vec3(glm::sqrt(variance))};
}

void refuseGlossy(const Settings& settings) {
  if (settings.gather.glossy)
    throw InputError("setting gather.glossy", "cannot be on here (tracked pixels are taken as Lambert surfaces)");
}

void WatchedScene::update(const SceneView& view) {
  if (!rays_) rays_ = std::make_unique<EmbreeQuery>(*view.assets);
  rays_->update(view);
  lights_ = collectLights(view);
  surfaces_ = surfacesAt(*rays_, view.camera, points_);
  seen_.emplace_back();
  for (const SurfaceHit& s : surfaces_) seen_.back().push_back(s.valid());
}

} // namespace lambent
