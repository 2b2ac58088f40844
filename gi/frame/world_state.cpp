#include "gi/frame/world_state.h"

#include <algorithm>
#include <utility>

namespace lambent {

namespace {

constexpr SceneChanges kAllChanged{true, true, true, true, true};

/// All maps are redrawn when their far distance changes, so it leaves room to grow.
float farDistanceOf(const SceneView& view, float before) {
  const float wanted = std::max(view.boundsWorld.diameter(), 1e-20f); // all in one place, as far as floats tell
  if (wanted <= before && wanted >= 0.5f * before) return before;
  return view.changes.geometry && before > 0 ? 1.25f * wanted : wanted;
}

} // namespace

bool WorldState::open(const SceneAssets& assets, const Settings& settings, FrameStats& stats) {
  const bool same = opened_ == assets.identity.value();
  if (same && revision_ == assets.revision) return false;
  CpuScope scope(stats.stages, key(StageId::Scene));
  const bool freezes = frozen_ || settings.effects[EffectId::Motion] == EffectMode::Off;
  const bool another = !same || freezes; // frozen instances may show what has gone
  opened_ = 0;                           // until it is: a pulse may throw
  if (another) {
    gpu_ = std::make_unique<GpuScene>(context_, assets);
    rays_ = std::make_unique<EmbreeQuery>(assets);
    view_ = {};
    frozen_ = false;
    lightingStale_ = surfacesStale_ = true;
    testedDraws_ = 0;
  } else {
    gpu_->takeAssets(assets);
    rays_->takeAssets();
  }
  opened_ = assets.identity.value();
  revision_ = assets.revision;
  return another;
}

void WorldState::take(const SceneView& given, const Settings& settings) {
  const bool freeze = settings.effects[EffectId::Motion] == EffectMode::Off && !view_.view().instances.empty();
  view_.take(given, freeze);
  if (frozen_ && !freeze) lightingStale_ = surfacesStale_ = true;
  frozen_ = freeze;
}

EffectPlan WorldState::plan(const Settings& settings, const PlanInputs& in) {
  const bool fresh = before_.effects != settings.effects || in.first;
  lightingStale_ |= fresh;
  surfacesStale_ |= fresh;
  Settings gather = settings; // but for what does not touch what pixels gather
  gather.history = before_.history;
  gather.filter = before_.filter;
  gather.image = before_.image;
  gather.frame = before_.frame;
  gather.debug = before_.debug;
  gatherChanged_ = before_ != gather || shadersChanged_;
  const bool drawingChanged = before_ != settings || shadersChanged_ || in.host || hosted_;
  settingsChanged_ = before_.smc != settings.smc || before_.vpl != settings.vpl ||
                     before_.effects != settings.effects || before_.own != settings.own ||
                     before_.ownValues != settings.ownValues || in.first;
  before_ = settings;
  shadersChanged_ = false;
  hosted_ = in.host;
  const FrameFacts facts{.first = in.first,
                         .settingsChanged = settingsChanged_,
                         .drawingChanged = drawingChanged,
                         .needs = in.needs,
                         .status = in.status,
                         .directPending = in.directPending,
                         .mirrorsPending = in.mirrorsPending};
  SceneView& view = view_.view();
  EffectPlan plan = planEffects(view, settings, facts);
  const auto everything = [&] {
    const bool gathers = plan.on(EffectId::Gather) || !plan.calledFor(EffectId::Gather);
    return plan.on(EffectId::Indirect) && plan.on(EffectId::Redraw) && gathers;
  };
  if ((lightingStale_ && everything()) || (surfacesStale_ && plan.on(EffectId::Redraw))) {
    view.changes = kAllChanged;
    plan = planEffects(view, settings, facts);
  }
  const bool changed = view.changes.any();
  lightingStale_ = !everything() && (lightingStale_ || changed);
  surfacesStale_ = !plan.on(EffectId::Redraw) && (surfacesStale_ || changed);
  return plan;
}

World WorldState::place(const EffectPlan& plan, FrameStats& stats) {
  const uint64_t opened = std::exchange(opened_, 0); // what fails half-way is opened anew by the next frame
  CpuScope scope(stats.stages, key(StageId::Scene));
  using enum EffectId;
  const SceneView& view = view_.view();
  const AlphaTest alpha = !plan.on(Alpha) ? AlphaTest::None : plan.idle(Alpha) ? AlphaTest::All : AlphaTest::Needed;
  rays_->setAlphaTest(alpha);
  gpu_->setAlphaTest(alpha);
  rays_->setTextures(plan.on(Textures));
  stats.of(Motion) = rays_->update(view, plan.idle(Motion));
  gpu_->place(view.instances);
  moved_ = DirtyRegion(view);
  lights_ = collectLights(view, alpha != AlphaTest::None);
  if (!plan.on(Emissive)) {
    lights_.emitters.clear();
    lights_.triangles.clear();
    lights_.emission = false;
    lights_.tree = LightTree(lights_);
  }
  if (!plan.on(Sky)) lights_.sky = {};
  if (plan.on(Redraw)) farDistance_ = farDistanceOf(view, farDistance_);
  opened_ = opened;
  return current();
}

void WorldState::countWork(FrameStats& stats) {
  const EmbreeQuery::Work done = rays_->takeWork();
  stats.of(EffectId::Textures) = done.textureLookups;
  const uint64_t draws = gpu_->testedDraws();
  stats.of(EffectId::Alpha) = done.alphaTests + draws - std::exchange(testedDraws_, draws);
}

} // namespace lambent
