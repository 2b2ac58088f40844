#include "gi/cube/draw/still_cache.h"

#include "gi/contract/figures.h"
#include "gi/gather/draw_gather.h"
#include "gi/gather/stages.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr float kMixed = 16; // pictures in which one takes the other's place

/// What the light of a cube depends on.
bool sameLight(const Settings& a, const Settings& b) {
  return a.smc == b.smc && a.vpl == b.vpl && a.gather == b.gather && a.cube == b.cube && a.effects == b.effects;
}

} // namespace

void StillCache::watch(const SceneView& view, const Settings& settings) {
  const SceneChanges& c = view.changes;
  const bool changed = c.first || c.lights || c.geometry || c.instances || !sameLight(settings, settings_);
  settings_ = settings;
  still_ = changed ? 0 : still_ + 1;
  stale_ |= changed && cube_;
  if (stale_ && share_ <= 0) drop();
  const GatherRow& gather = rowOf(settings.gather.mode);
  wanted_ = !stale_ && settings.stillCache.after > 0 && still_ >= settings.stillCache.after && !gather.stored &&
            settings.vpl.source != VplSource::None;
  if (!wanted_ && share_ <= 0) drop();
}

SurfaceLighting StillCache::run(const StillCacheInputs& in, const SurfaceLighting& gathered, FrameStats& stats) {
  if (!wanted_ && share_ <= 0) return gathered;
  Settings settings = in.settings;
  settings.vpl.source = VplSource::Ir;
  settings.vpl.visibility = VplVisibility::None;
  settings.gather.mode = GatherMode::Cube;
  settings.frame.overlap = false;
  if (!photons_) {
    photons_ = makeSource(VplSource::Ir, context_);
    cube_ = makeCubeGather(context_);
    FrameStats ofPhotons; // the frame's own are of the technique that runs
    lights_ = photons_->run({in.world, in.plan, settings, in.seed, false, {}}, ofPhotons);
  }
  const ShadowedLights seen{lights_};
  const SurfaceLighting stored = cube_->run({.world = in.world,
                                             .surfaces = in.surfaces,
                                             .patches = in.patches,
                                             .seen = seen,
                                             .settings = settings,
                                             .bounces = in.bounces,
                                             .seed = in.seed,
                                             .stores = wanted_,
                                             .most = uint32_t(settings.stillCache.perFrame)},
                                            stats);
  if (!stored.irradiance) return gathered; // not all is in it yet
  share_ = std::clamp(share_ + (wanted_ ? 1 : -1) / kMixed, 0.0f, 1.0f);
  if (alone() || !gathered.irradiance) return stored;
  const gl::PassScope scope = context_.scope(StageId::Gather);
  if (!mixed_) mixed_ = std::make_unique<LightTarget>("stand-in");
  mixed_->fit(in.surfaces);
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
