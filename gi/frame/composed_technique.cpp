#include "gi/frame/composed_technique.h"

#include "engine/gl/counts.h"
#include "gi/contract/figures.h"

namespace lambent {

namespace {

/// Light is averaged over frames. (Forced, it has nothing to do.)
bool averages(const EffectPlan& plan) { return plan.on(EffectId::History) && plan.calledFor(EffectId::History); }

// Frames after motion until a view counts as standing. relMSE of one that stopped, 6, 12 and 19 frames after (citadel):
// 0.024, 0.019, 0.019; without them 0.043, 0.027, 0.026.
constexpr int kRest = 24;
constexpr int kSteps = 2; // of the denoiser; a third takes 0 to 1 % off the error of hall and citadel

} // namespace

void ComposedTechnique::wait() {
  if (source_) source_->wait();
}

/// A part of another kind is given up with all that it keeps.
void ComposedTechnique::begin(const SceneView&, const Settings& settings) {
  const Axes axes = axesOf(settings);
  if (!sameSource(axes, axes_)) source_ = makeSource(axes, context_);
  if (!gather_ || !sameGather(axes, axes_)) {
    gathered_ = {};
    if (gather_) shown_ = std::move(gather_);
    gather_ = makeGather(axes, context_);
  }
  axes_ = axes;
  needs_ = needsOf(axes);
}

void ComposedTechnique::forget() {
  if (source_) source_->forget();
  maps_.forget();
  history_.forget();
  change_.forget();
  gathered_ = {};
}

ProviderStatus ComposedTechnique::status() const {
  return {.settled = source_ && source_->settled(),
          .lightArrived = source_ && source_->arrived(),
          .mapsWaiting = maps_.waiting(),
          .averaged = averaged_};
}

ProviderInside ComposedTechnique::inside() const {
  return {gathered_, maps_.maps(), source_ ? source_->set() : nullptr};
}

void ComposedTechnique::update(const FrameWorld& in, FrameStats& stats) {
  if (!averages(in.plan) || in.gatherChanged) history_.forget();
  lights_ = {};
  const bool gathers = in.plan.on(EffectId::Gather) || needs_.sampled();
  if (source_ && in.plan.on(EffectId::Indirect) && gathers) lights_ = source_->run(in, needs_, stats);
  stats.vplsAlive = lights_.alive;
}

SurfaceLighting ComposedTechnique::run(const Frame& frame, FrameStats& stats) {
  gathered_ = {};
  shown_ = nullptr;
  if (!frame.plan.on(EffectId::Gather) && !needs_.stored) {
    history_.forget(); // it would be of another place
    change_.forget();
    return {};
  }
  const gl::DrawCount draws;
  const EffectPlan& plan = frame.plan;
  const bool averaging = averages(plan), changes = averaging && plan.lightChanges();
  const ShadowedLights lights = maps_.update({frame, lights_, needs_.maps}, stats);
  if (averaging) history_.fit(frame.surfaces);
  const uint32_t sample = averaging ? history_.sample() : 0;
  const SceneChanges& world = frame.world.view.changes;
  const bool follows = averaging && (changes || history_.follows()), moves = follows || world.camera;
  restless_ = world.first ? 0 : moves ? kRest : std::max(0, restless_ - 1);
  const float rest = !averaging || moves ? 0 : needs_.lists ? 1 - float(restless_) / float(kRest) : 1;
  const bool stands = rest == 1;
  // Where a view stands, sixteen frames of classes by slot hold every light once, and lists only on the mean. A first
  // frame may be the first of these.
  const bool choose = needs_.lists && !stands && !(averaging && world.first);
  change_.observe({.lights = lights_,
                   .moved = frame.world.moved.boxes(),
                   .mapsWait = maps_.waiting() > 0,
                   .unknown = world.first || frame.settingsChanged});
  const LightLists* lists = nullptr;
  LightChangeMap change;
  if (choose) {
    const CpuScope scope(stats.stages, key(StageId::Lists));
    lists = &lists_.run({.view = frame.world.view,
                         .rays = frame.world.rays,
                         .lights = lights_.slots,
                         .gather = frame.settings.gather,
                         .sample = sample,
                         .seed = frame.seed},
                        stats.raysLists.closest);
    if (follows) change = change_.run(lists_.table(), frame.settings.gather.disk);
  }
  gathered_ = gather_->run({.frame = frame,
                            .lights = lights,
                            .lists = lists,
                            .sample = sample,
                            .averaged = averaging,
                            .changes = changes,
                            .rest = rest,
                            .stores = plan.on(EffectId::Gather)},
                           stats);
  if (plan.on(EffectId::Gather)) stats.of(EffectId::Gather) = draws();
  return reconstruct(frame, lists, change, stats);
}

SurfaceLighting ComposedTechnique::reconstruct(const Frame& frame, const LightLists* lists,
                                               const LightChangeMap& change, FrameStats& stats) {
  const EffectPlan& plan = frame.plan;
  const bool averaging = averages(plan);
  FilterSettings filter = frame.settings.filter;
  filter.on = filter.on && plan.on(EffectId::Filter);
  SurfaceLighting light = gathered_;
  if (averaging) {
    const gl::DrawCount draws;
    const bool otherNoise = byLists_ != (lists != nullptr);
    const SurfaceLighting before = lists && filter.on && history_.sample() > 0 ? smooth_ : SurfaceLighting{};
    light = history_.run({.surfaces = frame.surfaces,
                          .gathered = gathered_,
                          .cameraMoved = frame.world.view.changes.camera,
                          .lightChanges = plan.lightChanges(),
                          .settings = frame.settings.history,
                          .filter = filter,
                          .smooth = before,
                          .change = change.texture ? &change : nullptr,
                          .cycleFrames = lists && otherNoise ? float(kLightClasses) : 0,
                          .otherNoise = otherNoise});
    byLists_ = lists != nullptr;
    stats.of(EffectId::History) = draws();
    averaged_ = plan.changed() || lists ? 1 : averaged_ + 1; // counted from where lists end
  }
  const gl::DrawCount draws;
  // Of classes by slot every sixteen neighbours hold all lights, and the filter weighs them alike. Lists bring pixels
  // about the same, and their noise is told from edges of light.
  if (averaging && lists && light.subsets)
    light = denoise_.run({.surfaces = frame.surfaces,
                          .mean = light,
                          .variance = history_.variance(),
                          .worth = history_.worth(),
                          .filter = filter,
                          .steps = kSteps});
  else
    light = filter_.run({frame.surfaces, light, filter, averaging ? &history_.worth() : nullptr});
  if (filter.on) stats.of(EffectId::Filter) = draws();
  smooth_ = light;
  return light;
}

} // namespace lambent
