#include "gi/frame/mirror_pass.h"

#include "gi/gather/add_pixels.h"
#include "gi/near/mirror_rays.h"

#include <algorithm>

namespace lambent {

namespace {

// Earlier frames in a mean while the camera moves, and while light does: what a mirror shows does not move with its
// surface, and no coarse change of irradiance tells that it changes.
constexpr int kCameraMoves = 8, kLightChanges = 2;

} // namespace

void MirrorPass::forget() {
  history_.forget();
  averaged_ = 0;
}

SurfaceLighting MirrorPass::add(const Frame& frame, const SurfaceLighting& others, FrameStats& stats) {
  const SceneChanges& changes = frame.world.view.changes;
  const GBuffer& surfaces = frame.surfaces;
  const PixelBox pixels = mirrorsOf(frame.world.view);
  if (pixels.empty()) {
    forget();
    return others;
  }
  // Rays are drawn at random whether other light is averaged or not.
  const bool averages = frame.settings.effects[EffectId::History] != EffectMode::Off;
  const int frames = averages ? std::max(1, frame.settings.history.frames) : 1;
  if (frames < 2 || changes.first || frame.gatherChanged) forget();
  history_.fit(surfaces);
  std::vector<vec3> found;
  finish_.resize(size_t(surfaces.width) * size_t(surfaces.height));
  surfaces.finish->read(std::span(finish_), GL_RGBA, GL_FLOAT);
  {
    const CpuScope scope(stats.stages, key(StageId::MirrorRays));
    found = traceMirrors({.view = frame.world.view,
                          .rays = frame.world.rays,
                          .lights = frame.world.lights,
                          .pixels = pixels,
                          .samples = frame.settings.gather.mirrors,
                          .bounces = frame.bounces,
                          .finish = finish_,
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
  else if (frame.restart)
    rests_ = 3 * frames; // until what frames in motion blurred is forgotten
  averaged_ = frame.restart ? 1 : averaged_ + 1;
  const bool light = changes.lights || changes.geometry || changes.instances || frame.settingsChanged;
  const SurfaceLighting mean = history_.run({.surfaces = surfaces,
                                             .gathered = sampled,
                                             .cameraMoved = changes.camera || light,
                                             .lightChanges = false, // of irradiance, which is black here
                                             .settings = {.frames = frames},
                                             .filter = frame.settings.filter,
                                             .smooth = history_.sample() > 0 ? denoised_ : SurfaceLighting{},
                                             .glossyFrames = light ? kLightChanges : kCameraMoves});
  denoised_ = denoise_.run({surfaces, mean, history_.variance(), history_.worth(), frame.settings.filter});
  const gl::PassScope scope = context_.scope(StageId::Mirrors);
  sum_.fit(surfaces);
  sum_.clear();
  addLight(context_, others, sum_);
  addLight(context_, denoised_, sum_);
  return sum_.light();
}

} // namespace lambent
