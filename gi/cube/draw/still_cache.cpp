#include "gi/cube/draw/still_cache.h"

#include "gi/contract/figures.h"
#include "gi/cube/draw/cube_gather.h"
#include "gi/sources/sampled_source.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr float kMixed = 16; // frames in which one takes the other's place

/// What the light of a cube depends on.
bool sameLight(const Settings& a, const Settings& b) {
  return a.smc == b.smc && a.vpl == b.vpl && a.gather == b.gather && a.cube == b.cube && a.effects == b.effects;
}

constexpr Axes kStored{VplSource::Ir, VplVisibility::None, GatherMode::Cube, Reconstruction::None};

} // namespace

void StillCache::drop() {
  photons_ = nullptr;
  if (cube_) shown_ = std::move(cube_);
  share_ = 0;
  stale_ = false;
}

void StillCache::forget() {
  technique_->forget();
  drop();
  still_ = 0;
  wanted_ = false;
}

/// Has light stood still long enough?
void StillCache::begin(const SceneView& view, const Settings& settings) {
  technique_->begin(view, settings);
  const SceneChanges& c = view.changes;
  const bool changed = c.first || c.lights || c.geometry || c.instances || !sameLight(settings, settings_);
  settings_ = settings;
  still_ = changed ? 0 : still_ + 1;
  stale_ |= changed && cube_;
  if (stale_ && share_ <= 0) drop();
  const int after = settings.stillCache.after;
  wanted_ = !stale_ && after > 0 && still_ >= after && !needsOf(settings).stored;
  if (!wanted_ && share_ <= 0) drop();
}

ProviderStatus StillCache::status() const {
  ProviderStatus status = technique_->status();
  status.stored = alone();
  if ((wanted_ && !alone()) || (!wanted_ && share_ > 0)) status.pending = "a cube takes the place of the gather";
  return status;
}

void StillCache::update(const FrameWorld& in, FrameStats& stats) {
  technique_->update(in, stats);
  if (in.plan.on(EffectId::Indirect)) return;
  drop();
  still_ = 0;
  wanted_ = false;
}

SurfaceLighting StillCache::run(const Frame& frame, FrameStats& stats) {
  shown_ = nullptr;
  const SurfaceLighting gathered = technique_->run(frame, stats);
  if (!wanted_ && share_ <= 0) return gathered;
  const SurfaceLighting stored = lookUp(frame, stats);
  if (!stored.irradiance) return gathered; // not all is in it yet
  share_ = std::clamp(share_ + (wanted_ ? 1 : -1) / kMixed, 0.0f, 1.0f);
  return alone() || !gathered.irradiance ? stored : mix(frame, gathered, stored);
}

SurfaceLighting StillCache::lookUp(const Frame& frame, FrameStats& stats) {
  Settings settings = frame.settings;
  settings.vpl.source = kStored.source;
  settings.vpl.visibility = kStored.visibility;
  settings.gather.mode = kStored.gather;
  settings.frame.overlap = false;
  const FrameWorld world{.world = frame.world, .plan = frame.plan, .settings = settings, .seed = frame.seed};
  if (!photons_) {
    photons_ = std::make_unique<SampledSource>(context_);
    cube_ = makeCubeGather(context_);
    FrameStats ofPhotons; // the frame's own are of the technique that runs
    lights_ = photons_->run(world, needsOf(kStored), ofPhotons);
  }
  const Frame stored{world, frame.surfaces, frame.patches, frame.previous, frame.bounces};
  return cube_->run(
      {.frame = stored, .lights = {lights_}, .stores = wanted_, .most = uint32_t(frame.settings.stillCache.perFrame)},
      stats);
}

SurfaceLighting StillCache::mix(const Frame& frame, const SurfaceLighting& gathered, const SurfaceLighting& stored) {
  const gl::PassScope scope = context_.scope(StageId::Gather);
  if (!mixed_) mixed_ = std::make_unique<LightTarget>("still cache");
  mixed_->fit(frame.surfaces);
  std::vector<std::string> defines;
  const auto bind = [&](const SurfaceLighting& light, uint32_t unit) {
    light.irradiance->bind(unit);
    if (light.glossy) light.glossy->bind(unit + 1);
  };
  if (stored.glossy) defines.push_back("GLOSSY");
  const gl::Program& program = context_.programs.get({.fragment = "mix_light.frag", .defines = std::move(defines)});
  program.use();
  program.set("share", share_);
  bind(gathered, 2);
  bind(stored, 4);
  mixed_->bind();
  gl::PipelineState{.width = mixed_->size().x, .height = mixed_->size().y}.apply();
  gl::drawFullscreen();
  return mixed_->light();
}

} // namespace lambent
