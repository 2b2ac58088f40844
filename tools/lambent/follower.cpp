#include "tools/lambent/follower.h"

#include <algorithm>

namespace lambent {

Follower::Follower(const Settings& settings, const std::string& name, uint32_t seed, std::optional<GlContext>& context)
    : settings_(settings), seed_(seed) {
  run.name = name;
  const bool reflective = rowOf(settings_.vpl.source).reflective;
  if (!reflective) run.vpls = uint32_t(settings_.smc.vpls);
  if (!reflective && settings_.vpl.visibility != VplVisibility::Maps) return;
  if (!context) context.emplace(GlContext::headless());
  gi_.emplace(settings_, seed_);
}

std::vector<vec3> Follower::frame(const SceneView& view, const RayQuery& rays, const LightSet& lights,
                                  std::span<const vec2> points, std::span<const SurfaceHit> surfaces) {
  if (gi_) return drawn(view, points);
  VplUpdateLog log;
  placeVpls(settings_.vpl.source, set_, {view, rays, lights, settings_.smc, seed_, settings_.vpl}, log);
  place(log.stages);
  RayCounts counts;
  std::vector<vec3> out = irradianceByRays(rays, surfaces, lightsOf(set_), settings_.gather, counts);
  for (size_t i = 0; i < out.size(); ++i) out[i] *= surfaces[i].albedo / kPi;
  return out;
}

std::vector<vec3> Follower::drawn(const SceneView& view, std::span<const vec2> points) {
  const FrameStats& stats = gi_->run(view);
  place(stats.stages);
  run.vpls = std::max(run.vpls, stats.vplsAlive);
  const Image picture = gi_->read(Buffer::Indirect);
  std::vector<vec3> out;
  for (const vec2& p : points) {
    const int x = std::min(int(p.x * float(picture.width)), picture.width - 1);
    const int y = std::min(int(p.y * float(picture.height)), picture.height - 1);
    out.push_back(picture.at(x, y));
  }
  return out;
}

double Follower::medianPlaceMs() {
  if (placeMs_.size() > 1) placeMs_.erase(placeMs_.begin());
  std::nth_element(placeMs_.begin(), placeMs_.begin() + placeMs_.size() / 2, placeMs_.end());
  return placeMs_[placeMs_.size() / 2];
}

void Follower::place(const std::vector<StageTime>& stages) {
  double ms = 0;
  for (const StageTime& s : stages) ms += s.cpuMs;
  placeMs_.push_back(ms);
}

} // namespace lambent
