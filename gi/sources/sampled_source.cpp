// When the set of VPLs is updated, and what the GPU gets of it.
#include "gi/sources/sampled_source.h"

#include "engine/core/parallel.h"
#include "engine/view/view_copy.h"
#include "gi/contract/figures.h"
#include "gi/vpl/asked_memory.h"

#include <algorithm>
#include <chrono>
#include <iterator>

namespace lambent {

namespace {

/// What an update depends on, apart from the world.
struct UpdateTask {
  SmcSettings smc;
  VplSettings vpl;
  VplEffects effects;
  bool settingsChanged = false;
  uint32_t seed = 1;
};

UpdateTask taskOf(const FrameWorld& in) {
  using enum EffectId;
  UpdateTask task{in.settings.smc, in.settings.vpl, {}, in.settingsChanged, in.seed};
  if (!in.plan.on(Bounces)) task.smc.bounces = std::min(task.smc.bounces, 1);
  task.effects = {.replace = in.plan.on(Replace),
                  .relight = in.plan.on(Relight),
                  .relightAll = in.plan.idle(Relight),
                  .carryAll = in.plan.idle(Motion),
                  .lastRays = in.plan.idle(Emissive) || in.plan.idle(Sky)};
  return task;
}

std::vector<uint32_t> join(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
  std::vector<uint32_t> all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

/// One update. Slots that moved before and were not shown stay listed.
VplWork updated(VplWork work, const UpdateTask& task, const SceneView& view, const RayQuery& rays,
                const LightSet& lights, const std::function<void(int, int)>& progress) {
  work.log = {};
  const VplUpdate in{view, rays, lights, task.smc, task.seed, task.vpl, task.effects, task.settingsChanged};
  const auto begin = std::chrono::steady_clock::now();
  VplChanges now = placeVpls(task.vpl.source, work.set, in, work.log, progress);
  work.log.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  now.movedSlots = join(now.movedSlots, work.changes.movedSlots);
  now.placedSlots = join(now.placedSlots, work.changes.placedSlots);
  work.changes = std::move(now);
  return work;
}

} // namespace

VirtualLights SampledSource::run(const FrameWorld& in, const Needs& needs, FrameStats& stats) {
  using enum EffectId;
  const World& world = in.world;
  const auto called = [&](EffectId id) { return in.plan.on(id) && in.plan.calledFor(id); };
  const bool persistent = needs.persistent();
  const bool needed = kept_.set.slots.empty() || called(Replace) || (persistent && (called(Relight) || called(Motion)));
  // Forced by settings though nothing calls for it: done on a copy that is thrown away.
  const bool onACopy = !needed && persistent && (in.plan.on(Replace) || in.plan.on(Relight) || in.plan.on(Motion));
  const bool overlapped = in.settings.frame.overlap && needed && !kept_.set.slots.empty();
  std::vector<uint32_t> carried;
  if (overlapped && persistent) { // others place theirs again
    carried = carryVpls(kept_.set, world.view, world.view.changes.first);
  } else if (onACopy) {
    kept_.log = updated(kept_, taskOf(in), world.view, world.rays, world.lights, in.progress).log;
  } else if (needed && !overlapped) {
    kept_ = updated(std::move(kept_), taskOf(in), world.view, world.rays, world.lights, in.progress);
  }
  report(in.plan, stats);
  VirtualLights lights;
  if (in.plan.on(Redraw)) lights = show(overlapped, carried, needs.lightsOnGpu);
  lights.alive = kept_.changes.alive;
  if (overlapped)
    running_ = std::async(std::launch::async, [work = std::move(kept_), task = taskOf(in), copy = ViewCopy(world.view),
                                               rays = &world.rays, shining = world.lights,
                                               reading = Readers::Reading(world.view.assets->readers),
                                               workers = Workers::current()]() mutable {
      const Readers::Reading until = std::move(reading); // the end of this, not of who waits for it
      shining.view = &copy.view();
      VplWork done;
      const auto update = [&] { done = updated(std::move(work), task, copy.view(), *rays, shining, {}); };
      workers ? workers->run(update) : update();
      return done;
    });
  return lights;
}

void SampledSource::wait() {
  if (!running_.valid()) return;
  kept_ = running_.get();
  arrived_ = true;
}

/// Figures of the update that this frame shows.
void SampledSource::report(const EffectPlan& plan, FrameStats& stats) {
  arrived_ = false;
  held_.now(bytesHeld(kept_.set));
  VplUpdateLog& log = kept_.log;
  const VplChanges& changes = kept_.changes;
  stats.stages.insert(stats.stages.end(), log.stages.begin(), log.stages.end());
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
  stats.vplsStrong = changes.strong;
  stats.burst = changes.burst;
  for (const auto* all : {&kept_.set.samplerPaths, &kept_.set.lightPaths, &kept_.set.poolPaths})
    for (const KeptPaths& k : *all) stats.pathsHeld += k.lengths.size();
  stats.pathsTraced = log.paths.traced;
  stats.pathsRetraced = log.paths.retraced;
  const auto total = [](const RayCounts& c) { return c.closest + c.occlusion; };
  using enum EffectId;
  stats.of(Bounces) = log.paths.bounceRays;
  stats.of(Relight) = log.relitForChange;
  stats.of(Replace) = total(log.points) + total(log.validation) + total(log.candidates);
  stats.of(Indirect) = stats.of(Replace) + total(log.radiosity) + total(log.cells);
  if (plan.on(Emissive)) stats.of(Emissive) += log.paths.lastRays;
  if (plan.on(Sky)) stats.of(Sky) += log.paths.lastRays;
  log = {};
}

/// With `overlapped` the set is still that of the last update; the `carried` slots stand where their objects are now.
VirtualLights SampledSource::show(bool overlapped, const std::vector<uint32_t>& carried, bool onGpu) {
  VplChanges& changes = kept_.changes;
  VirtualLights lights;
  // Those that were carried by the update of the frame before stand where that frame had put them.
  lights.moved = changes.placedSlots;
  const std::vector<uint32_t> elsewhere = overlapped ? carried : join(changes.movedSlots, carried);
  std::set_difference(elsewhere.begin(), elsewhere.end(), lights.moved.begin(), lights.moved.end(),
                      std::back_inserter(lights.carried));
  for (std::vector<uint32_t>* slots : {&lights.moved, &lights.carried})
    std::erase_if(*slots, [&](uint32_t slot) { return slot >= kept_.set.slots.size(); });
  changes.movedSlots.clear(); // who sees the lights has heard of them
  changes.placedSlots.clear();
  shown_ = lightsOf(kept_.set);
  lights.slots = shown_;
  lights.direct = kept_.set.direct;
  lights.mayWait = true;
  if (onGpu) lights.packed = buffer_.run(shown_);
  return lights;
}

} // namespace lambent
