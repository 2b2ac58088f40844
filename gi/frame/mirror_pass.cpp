#include "gi/frame/mirror_pass.h"

#include "gi/gather/add_pixels.h"
#include "gi/near/mirror_rays.h"

namespace lambent {

namespace {

constexpr float kReflectedFollow = 0.3f; // of a coarse change, in its first frame; as soft light
// Earlier frames while camera or light moves. What a mirror shows does not move with its surface.
constexpr int kInMotion = 8;

} // namespace

void MirrorPass::forget() {
  history_.forget();
  averaged_ = 0;
}

SurfaceLighting MirrorPass::add(const Frame& frame, const SurfaceLighting& light, FrameStats& stats) {
  const SceneChanges& changes = frame.world.view.changes;
  const GBuffer& surfaces = frame.surfaces;
  const PixelBox pixels = mirrorsOf(frame.world.view);
  if (pixels.empty()) {
    forget();
    return light;
  }
  const int frames = frame.plan.on(EffectId::History) ? frame.settings.history.frames : 1;
  if (frames < 2 || changes.first || frame.gatherChanged) forget();
  history_.fit(surfaces);
  std::vector<vec3> found;
  {
    const CpuScope scope(stats.stages, key(StageId::MirrorRays));
    found = traceMirrors({.view = frame.world.view,
                          .rays = frame.world.rays,
                          .lights = frame.world.lights,
                          .pixels = pixels,
                          .samples = frame.settings.gather.mirrors,
                          .bounces = frame.bounces,
                          .normalMaps = surfaces.mappedNormal != nullptr,
                          .seed = frame.seed,
                          .sample = history_.sample()},
                         stats.raysMirrors);
    stats.of(EffectId::Mirrors) += stats.raysMirrors.closest + stats.raysMirrors.occlusion;
  }
  SurfaceLighting sampled;
  {
    const gl::PassScope scope = context_.scope(StageId::Mirrors);
    samples_.fit(surfaces);
    sampled = samples_.light();
    sampled.irradiance->clear();
    uploadPixels(*sampled.glossy, found, surfaces, 1);
  }
  if (history_.sample() == 0)
    rests_ = frames;
  else if (frame.plan.seenChanges())
    rests_ = 3 * frames; // until what frames in motion blurred is forgotten
  averaged_ = frame.plan.seenChanges() ? 1 : averaged_ + 1;
  const SurfaceLighting mean =
      history_.run({.surfaces = surfaces,
                    .gathered = sampled,
                    .cameraMoved = changes.camera,
                    .lightChanges = changes.lights || changes.geometry || changes.instances || frame.settingsChanged,
                    .settings = {.frames = frames},
                    .filter = frame.settings.filter,
                    .follow = kReflectedFollow,
                    .smooth = history_.sample() > 0 ? denoised_ : SurfaceLighting{},
                    .apart = true,
                    .glossyFrames = kInMotion});
  denoised_ = denoise_.run({surfaces, mean, history_.variance(), history_.worth(), frame.settings.filter});
  const gl::PassScope scope = context_.scope(StageId::Mirrors);
  sum_.fit(surfaces);
  sum_.clear();
  addLight(context_, light, sum_);
  addLight(context_, denoised_, sum_);
  return sum_.light();
}

} // namespace lambent
