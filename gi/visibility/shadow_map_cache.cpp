#include "gi/visibility/shadow_map_cache.h"

#include "gi/lighting/dirty_region.h"

#include <algorithm>
#include <limits>

namespace lambent {

ShadowedLights ShadowMapCache::update(const ShadowMapInputs& in, FrameStats& stats) {
  const World& world = in.frame.world;
  const ShadowSettings& shadow = in.frame.settings.shadow;
  maps_ = {};
  if (!in.lights.mayWait) schedule_.clear();
  if (!in.maps) {
    old_ = true;
    return {in.lights};
  }
  std::vector<MapPose> poses;
  poses.reserve(in.lights.slots.size());
  for (const VirtualLight& light : in.lights.slots) // of none that lives: another pose than it has when it does
    poses.push_back(light.pose(light.alive ? world.rays.rayEpsilon() : 0));
  std::swap(poses_, poses); // `poses` are those before
  ParaboloidMapInputs maps{.scene = world.gpu,
                           .rays = &world.rays,
                           .poses = poses_,
                           .farDistance = world.farDistance,
                           .resolution = shadow.resolution,
                           .maker = shadow.maker};
  std::vector<MapJob> jobs;
  maps.jobsAreAll = pass_.redrawsAll(maps);
  if (maps.jobsAreAll) schedule_.clear();
  const bool all = maps.jobsAreAll || world.view.changes.first || old_;
  const bool follow =
      in.lights.mayWait && shadow.refresh > 0 && in.frame.settings.effects[EffectId::MapRefresh] != EffectMode::Off;
  const int step = fresh_ && follow ? firstMapStep(shadow.firstMaps, world.view.rayWork) : 1;
  fresh_ = false;
  if (step > 1 || maps.jobsAreAll || !in.lights.mayWait) {
    jobs = jobsAtOnce(poses_, poses, in.lights.slots, world.moved.boxes(), all || step > 1, shadow.resolution);
    for (MapJob& job : jobs) job.step = step;
  } else {
    jobs = inTurn(in, stats);
  }
  old_ = false;
  maps.jobs = jobs;
  maps_ = pass_.run(maps);
  if (step > 1) {
    if (!pass_.maker().gpu()) schedule_.drawnCoarsely(jobs, poses_.size()); // the GPU draws them whole
    for (const MapJob& job : jobs) stats.mapTexelsDrawn += uint64_t(texelsTraced(job.texels, step));
    stats.mapsWaiting = waiting();
  }
  stats.mapsDrawn += pass_.mapsDrawn();
  stats.of(EffectId::Indirect) += pass_.mapsDrawn();
  stats.makerTimes = pass_.maker().report();
  stats.shadowMaker = pass_.maker().maker();
  return {in.lights, &maps_};
}

/// Maps of lights that stand elsewhere, and as far as the budget goes of those that see where objects moved.
std::vector<MapJob> ShadowMapCache::inTurn(const ShadowMapInputs& in, FrameStats& stats) {
  const World& world = in.frame.world;
  const SceneView& view = world.view;
  const EffectPlan& plan = in.frame.plan;
  const ShadowSettings& shadow = in.frame.settings.shadow;
  const int resolution = shadow.resolution;
  std::vector<float> brightness;
  for (const VirtualLight& light : in.lights.slots) {
    // A light that brings nothing now may do so later, so its map is not given up.
    brightness.push_back(light.alive ? std::max(light.intensity(), 1e-20f) : 0);
  }
  int64_t budget = int64_t(shadow.refresh) * resolution * resolution;
  if (view.changes.first || old_) {
    schedule_.invalidateAll(poses_.size(), resolution);
    budget = std::numeric_limits<int64_t>::max();
  } else if (!plan.on(EffectId::MapRefresh)) {
    budget = 0;
  } else if (plan.idle(EffectId::MapRefresh)) {
    schedule_.invalidateInTurn(poses_.size(), size_t(shadow.refresh), resolution);
  } else if (view.changes.geometry || view.changes.instances) {
    schedule_.invalidate(poses_, brightness, world.moved, world.rays, resolution, shadow.motionRays, in.frame.seed,
                         stats.frame, stats.raysMapTests);
  }
  // A map goes where its light goes: what rides along is seen right, the rest as late as other maps in motion.
  if (plan.on(EffectId::MapRefresh)) schedule_.invalidateWhole(in.lights.carried, poses_.size(), resolution);
  const std::vector<MapJob> jobs = schedule_.take(in.lights.moved, brightness, resolution, budget);
  stats.mapsWaiting = waiting();
  stats.of(EffectId::MapRefresh) = jobs.size() - in.lights.moved.size() + stats.raysMapTests.occlusion;
  for (const MapJob& job : jobs) stats.mapTexelsDrawn += uint64_t(texelsTraced(job.texels, job.step));
  return jobs;
}

std::vector<MapJob> jobsAtOnce(std::span<const MapPose> poses, std::span<const MapPose> before,
                               std::span<const VirtualLight> lights, std::span<const Aabb> moved, bool all,
                               int resolution) {
  std::vector<MapJob> jobs;
  for (uint32_t slot = 0; slot < poses.size(); ++slot) {
    if (!lights[slot].alive) continue;
    TexelRect texels;
    if (all || slot >= before.size() || before[slot] != poses[slot])
      texels = TexelRect::whole(resolution);
    else
      for (const Aabb& box : moved) texels.add(texelsCovered(poses[slot], box, resolution));
    if (!texels.empty()) jobs.push_back({slot, texels});
  }
  return jobs;
}

} // namespace lambent
