#include "gi/direct/soft_light.h"

#include "gi/gather/add_pixels.h"

#include <utility>

namespace lambent {

namespace {

// A frame's samples are noisier than gathered light, so means follow a change less at once; what exceeds their noise is
// followed wholly (shaders/history_follow.frag).
constexpr float kFollow = 0.3f; // of a coarse change, in its first frame
constexpr int kGlossy = 8;      // earlier frames of glossy light while camera or light moves

} // namespace

MoreSamples SoftLightPass::more(const Frame& frame) {
  if (!next_ || history_.sample() == 0 || !frame.plan.seenChanges()) return {};
  nextPixels_.resize(size_t(next_.width()) * size_t(next_.height()));
  next_.read(std::span(nextPixels_), GL_RED, GL_UNSIGNED_BYTE);
  return {nextPixels_, next_.width(), next_.height(), before_.clipFromWorld};
}

void SoftLightPass::findNext(const Frame& frame) {
  const DirectSettings& settings = frame.settings.direct;
  if (settings.mostSamples <= settings.samples) {
    next_ = {}, nextFramebuffer_ = {};
    return;
  }
  const GBuffer& surfaces = frame.surfaces;
  if (!next_ || next_.width() != surfaces.width || next_.height() != surfaces.height) {
    next_ = gl::Texture("soft light/samples", {.format = GL_R8, .width = surfaces.width, .height = surfaces.height});
    nextFramebuffer_ = gl::Framebuffer("soft light/samples", {&next_});
  }
  const gl::Program& program = context_.programs.get({.fragment = "soft_samples.frag"});
  program.use();
  program.set("samples", float(settings.samples));
  program.set("mostSamples", float(settings.mostSamples));
  denoised_.irradiance->bind(2);
  history_.variance().bind(3);
  history_.worth().bind(4);
  nextFramebuffer_.bind();
  gl::PipelineState{.width = surfaces.width, .height = surfaces.height}.apply();
  gl::drawFullscreen();
  before_ = surfaces.block;
}

void SoftLightPass::add(const Frame& frame, SurfaceReader& reader, SoftParts parts, const LightTarget& target,
                        FrameStats& stats) {
  const LightSet lights = softLightsOf(frame.world.lights, parts);
  if (lights.empty()) return forget();
  const SceneChanges& changes = frame.world.view.changes;
  const int frames = frame.settings.direct.frames;
  const bool others = std::exchange(parts_, parts) != parts;
  if (frames < 2 || changes.first || others) history_.forget();
  history_.fit(frame.surfaces);
  const bool glossy = frame.surfaces.finish != nullptr;
  SoftLight found;
  {
    const CpuScope scope(stats.stages, key(StageId::SoftRays));
    RayCounts counts;
    // What blends is drawn by alphas of other texels than rays meet, where its texture is minified.
    const bool byImage = frame.settings.direct.surfaces == SoftSurfaces::Image || frame.surfaces.blended;
    const FrameSurfaces surfaces = byImage ? reader.read(frame.surfaces) : FrameSurfaces{};
    const int samples = frame.settings.direct.samples;
    found = sampleSoftLight({.rays = frame.world.rays,
                             .lights = lights,
                             .view = frame.world.view,
                             .surfaces = byImage ? &surfaces : nullptr,
                             .samples = samples,
                             .more = more(frame),
                             .sample = history_.sample() * uint32_t(samples),
                             .glossy = glossy,
                             .normalMaps = frame.surfaces.mappedNormal != nullptr,
                             .seed = frame.seed},
                            counts);
    stats.raysSoft += counts;
    const uint64_t rays = counts.closest + counts.occlusion;
    if (!lights.emitters.empty()) stats.of(EffectId::Emissive) += rays, stats.of(EffectId::SoftShadows) += rays;
    if (!lights.sky.black()) stats.of(EffectId::Sky) += rays;
  }
  SurfaceLighting sampled;
  {
    const gl::PassScope scope = context_.scope(StageId::SoftLight);
    samples_.fit(frame.surfaces);
    sampled = samples_.light();
    uploadPixels(*sampled.irradiance, found.irradiance, frame.surfaces, 1);
    if (glossy) uploadPixels(*sampled.glossy, found.glossy, frame.surfaces, 1);
  }
  sampled.subsets = true; // pixels side by side took other strata
  // What frames in motion have brought is a little blurred: a view that stands after them rests when it is forgotten.
  if (history_.sample() == 0)
    rests_ = frames;
  else if (frame.plan.seenChanges())
    rests_ = 3 * frames;
  averaged_ = frame.plan.seenChanges() ? 1 : averaged_ + 1;
  const SurfaceLighting mean =
      history_.run({.surfaces = frame.surfaces,
                    .gathered = sampled,
                    .cameraMoved = changes.camera,
                    .lightChanges = changes.lights || changes.geometry || changes.instances || frame.settingsChanged,
                    .settings = {.frames = frames},
                    .filter = frame.settings.filter,
                    .follow = kFollow,
                    .smooth = history_.sample() > 0 ? denoised_ : SurfaceLighting{},
                    .apart = true,
                    .glossyFrames = kGlossy});
  denoised_ = denoise_.run({frame.surfaces, mean, history_.variance(), history_.worth(), frame.settings.filter});
  const gl::PassScope scope = context_.scope(StageId::SoftLight);
  addLight(context_, denoised_, target);
  findNext(frame);
}

} // namespace lambent
