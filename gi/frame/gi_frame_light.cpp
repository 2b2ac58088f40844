// The VPLs of a frame: when they are updated, and which of their maps are drawn.
#include "gi/frame/gi_frame_state.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace lambent {

/// Updates the VPLs, or starts to, and gets ready what the GPU needs of those that this frame shows.
void GiFrame::State::updateLight(const std::function<void(int, int)>& progress) {
  using enum EffectId;
  if (fromReflectiveMaps(settings.vpl.source)) { // the GPU makes its VPLs when it draws
    finishUpdate();
    vpls = {};
    changes = {};
    mapSchedule.clear();
    return;
  }
  reflectiveMapsOld = true;
  const auto called = [&](EffectId id) { return plan.on(id) && plan.calledFor(id); };
  const bool smc = settings.vpl.source == VplSource::Smc;
  const bool needed = vpls.slots.empty() || called(Replace) || (smc && (called(Relight) || called(Motion)));
  const bool pretended = !needed && smc && (plan.on(Replace) || plan.on(Relight) || plan.on(Motion));
  const bool beside = settings.frame.overlap && needed && !vpls.slots.empty();
  std::vector<uint32_t> carried;
  if (beside && smc) // other sources place theirs anew
    carried = carryVpls(vpls, world.view, world.view.changes.first);
  else if (!beside && (needed || pretended))
    update(updateTask(pretended), progress);
  showUpdate();
  if (plan.on(Redraw)) prepareVplMaps(beside, carried);
  if (beside) updating = std::async(std::launch::async, [this, task = updateTask(false)] { update(task, {}); });
}

/// A copy of all that settings decide: they may change while the task runs.
UpdateTask GiFrame::State::updateTask(bool pretended) const {
  using enum EffectId;
  UpdateTask task{settings.smc, settings.vpl, {}, settingsChanged, pretended};
  if (!plan.on(Bounces)) task.smc.bounces = std::min(task.smc.bounces, 1);
  task.effects = {.replace = plan.on(Replace),
                  .relight = plan.on(Relight),
                  .relightAll = plan.idle(Relight),
                  .carryAll = plan.idle(Motion),
                  .lastRays = plan.idle(Emissive) || plan.idle(Sky)};
  return task;
}

void GiFrame::State::update(const UpdateTask& task, const std::function<void(int, int)>& progress) {
  VplUpdate in{world.view, *rays, lights, task.smc, seed, task.vpl, task.effects, task.settingsChanged};
  log = {};
  VplSet copy;
  if (task.pretended) copy = vpls;
  const auto begin = std::chrono::steady_clock::now();
  VplChanges now = placeVpls(task.vpl.source, task.pretended ? copy : vpls, in, log, progress);
  log.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  if (task.pretended) return;
  const auto join = [](std::vector<uint32_t>& slots, const std::vector<uint32_t>& unshown) {
    std::vector<uint32_t> all;
    std::set_union(slots.begin(), slots.end(), unshown.begin(), unshown.end(), std::back_inserter(all));
    slots = std::move(all);
  };
  join(now.movedSlots, changes.movedSlots);
  join(now.placedSlots, changes.placedSlots);
  changes = std::move(now);
}

/// Waits for the update that runs beside the GPU, if one does.
void GiFrame::State::finishUpdate() {
  if (!updating.valid()) return;
  updating.get();
  lightArrived = true;
}

/// Takes the figures of the update that this frame's picture shows.
void GiFrame::State::showUpdate() {
  lightArrived = false;
  for (StageTime& row : log.stages) stats.stages.push_back(std::move(row));
  stats.updateMs = log.ms;
  stats.raysPoints += log.points;
  stats.raysValidation = log.validation;
  stats.raysCandidates = log.candidates;
  stats.raysRadiosity = log.radiosity;
  stats.raysCells = log.cells;
  stats.vplsRelit = log.relit;
  stats.vplsKept = changes.kept;
  stats.vplsMoved = uint32_t(changes.movedSlots.size());
  stats.vplsInvalid = changes.invalid;
  stats.vplsAlive = changes.alive;
  stats.vplsStrong = changes.strong;
  stats.burst = changes.burst;
  for (const auto* all : {&vpls.samplerPaths, &vpls.lightPaths, &vpls.poolPaths})
    for (const KeptPaths& k : *all) stats.pathsHeld += k.lengths.size();
  stats.pathsTraced = log.paths.traced;
  stats.pathsRetraced = log.paths.retraced;
  const auto total = [](const RayCounts& c) { return c.closest + c.occlusion; };
  using enum EffectId;
  work(Bounces) = log.paths.bounceRays;
  work(Relight) = log.relitForChange;
  work(Replace) = total(log.points) + total(log.validation) + total(log.candidates);
  work(Indirect) = work(Replace) + total(log.radiosity) + total(log.cells);
  if (plan.on(Emissive)) work(Emissive) += log.paths.lastRays;
  if (plan.on(Sky)) work(Sky) += log.paths.lastRays;
  log = {};
}

/// Distance that stands for 1 in the maps. All are drawn anew when it changes, so it leaves room to grow.
float GiFrame::State::mapReach() {
  const float wanted = world.view.boundsWorld.diameter();
  if (wanted > farDistance || wanted < 0.5f * farDistance)
    farDistance = world.view.changes.geometry && farDistance > 0 ? 1.25f * wanted : wanted;
  return farDistance;
}

/// Lists the maps of lights that stand elsewhere, and as far as the budget goes of those that see where objects moved.
void GiFrame::State::prepareVplMaps(bool beside, const std::vector<uint32_t>& carried) {
  using enum EffectId;
  const SceneView& view = world.view;
  vplLights.clear();
  mapJobs.clear();
  if (settings.vpl.visibility == VplVisibility::Rays) {
    vplsShown = vpls.slots;
    vplMapsOld = true;
    return;
  }
  // Those that were carried by the update of the frame before stand where that frame had put them.
  const std::vector<uint32_t>& moved = beside ? changes.placedSlots : changes.movedSlots;
  std::vector<uint32_t> elsewhere;
  std::set_union(moved.begin(), moved.end(), carried.begin(), carried.end(), std::back_inserter(elsewhere));
  std::erase_if(elsewhere, [&](uint32_t slot) { return slot >= vpls.slots.size(); });
  changes.movedSlots.clear(); // they have their maps after this frame
  changes.placedSlots.clear();

  for (const Vpl& v : vpls.slots) vplLights.push_back(vplLight(v));
  if (settings.vpl.visibility == VplVisibility::None) {
    vplMapsOld = true;
    return;
  }
  const int resolution = settings.shadow.resolution;
  std::vector<float> brightness;
  for (const Vpl& v : vpls.slots) {
    // A light that brings nothing now may do so later, so its map is not given up.
    brightness.push_back(v.alive ? std::max(v.intensity(), 1e-20f) : 0);
  }
  poses = mapPoses(vpls);
  const ParaboloidMapInputs in{*gpuScene, rays.get(), poses, {}, mapReach(), resolution, settings.shadow.maker};
  if (vplMapPass.drawsAllAnew(in)) {
    mapSchedule.clear();
    vplMapsOld = false;
    return;
  }
  int64_t budget = int64_t(settings.shadow.refresh) * resolution * resolution;
  if (view.changes.first || vplMapsOld) {
    vplMapsOld = false;
    mapSchedule.disturbAll(poses.size(), resolution);
    budget = std::numeric_limits<int64_t>::max();
  } else if (!plan.on(MapRefresh)) {
    budget = 0;
  } else if (plan.idle(MapRefresh)) {
    mapSchedule.disturbInTurn(poses.size(), size_t(settings.shadow.refresh), resolution);
  } else if (view.changes.geometry || view.changes.instances) {
    mapSchedule.disturb(poses, brightness, disturbance, *rays, resolution, settings.shadow.motionRays, seed,
                        stats.frame, stats.raysMapTests);
  }
  mapJobs = mapSchedule.take(elsewhere, brightness, resolution, budget);
  stats.mapsWaiting = uint32_t(mapSchedule.waiting());
  work(MapRefresh) = mapJobs.size() - elsewhere.size() + stats.raysMapTests.occlusion;
  for (const MapJob& job : mapJobs) stats.mapTexelsDrawn += uint64_t(texelsTraced(job.texels, job.coarse));
}

} // namespace lambent
