#include "gi/viewer/viewer.h"

#include "engine/core/error.h"
#include "engine/core/open_watch.h"
#include "engine/core/text.h"
#include "engine/gl/state_guard.h"
#include "gi/viewer/viewer_stages.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace lambent {

struct Viewer::Passes {
  explicit Passes(PassContext c) : context(c) {}

  PassContext context;
  CompositePass composite{context}, part{context}; // part: direct or indirect light by itself
  ExposureMeter meter{context};
  DisplayPass display{context};
  TruthDisplay truth{context};
  FrameResults results;
  FrameStats stats;
};

Viewer::Viewer(const Settings& settings, uint32_t seed, Makers makers)
    : gi_(settings, seed, makers), passes_(std::make_unique<Passes>(gi_.context())) {}
Viewer::~Viewer() = default;

void Viewer::restart() {
  passes_.reset(); // before the programs that it draws with
  gi_.restart();
  passes_ = std::make_unique<Passes>(gi_.context());
  exposure_ = measured_ = firstMeasured_ = elapsed_ = 0;
}

/// Takes the exposure that the settings name, or that the image asks for.
void Viewer::expose(bool drawn, float elapsed) {
  constexpr float kMost = 64; // from what the first image with light asked for
  const ImageSettings& image = settings().image;
  if (image.exposure > 0) {
    exposure_ = image.exposure;
    given_ = true;
    return;
  }
  const gl::Texture* const radiance = passes_->results.radiance;
  const bool released = std::exchange(given_, false) && radiance; // what was drawn last says it
  if (released || (exposure_ <= 0 && drawn)) {
    measured_ = firstMeasured_ = passes_->meter.measureNow(*radiance);
    exposure_ = measured_ > 0 ? measured_ : 1;
  }
  if (!(image.adaptation > 0)) return;
  if (drawn) passes_->meter.measure(*radiance);
  if (!(measured_ > 0 && elapsed > 0)) return;
  const float wanted = std::clamp(measured_, firstMeasured_ / kMost, firstMeasured_ * kMost);
  exposure_ *= std::pow(wanted / exposure_, 1 - std::exp2(-elapsed / image.adaptation));
}

const FrameStats& Viewer::run(const SceneView& view, const std::function<void(int, int)>& progress,
                              const HostSurfaces* host) {
  const gl::StateGuard guard;
  FrameResults& results = passes_->results;
  const gl::Counts start = gl::counts();
  if (const float measured = passes_->meter.read(); measured > 0) { // a black image asks for nothing
    measured_ = measured;
    if (!(firstMeasured_ > 0)) firstMeasured_ = measured;
  }
  const gl::Counts metered = gl::counts() - start;
  FrameStats& stats = passes_->stats;
  const gl::Texture* const last = results.radiance;
  try {
    if (host && (host->albedo == 0 || !host->conventions.ours()))
      throw InputError("host's surfaces", "have no albedo, or conventions of their own (an image is composed of them)");
    stats = gi_.run(view, progress, host);
  } catch (...) { // the last frame stays where it was refused; what something is thrown out of in drawing is no frame
    results = gi_.outputs().surfaces.depth ? FrameResults{gi_.outputs(), last} : FrameResults{};
    throw;
  }
  const auto begin = std::chrono::steady_clock::now();
  const gl::Counts before = gl::counts();
  results = {gi_.outputs(), last};
  const bool drawn = stats.plan.on(EffectId::Redraw);
  if (drawn)
    results.radiance = &passes_->composite.run({.surfaces = results.surfaces,
                                                .direct = results.direct,
                                                .indirect = results.indirect,
                                                .sky = results.sky,
                                                .mixes = true});
  expose(drawn, std::exchange(elapsed_, 0.0f));
  if (OpenWatch::any()) {
    gl::finishToMeasure(); // drivers that draw on the CPU draw later
    OpenWatch::end();
  }
  for (const StageTime& row : passes_->context.profiler.takeRows()) stats.stages.push_back(row);
  const gl::Counts asked = gl::counts() - before;
  stats.draws += asked.draws;
  stats.waits += asked.waits + metered.waits;
  stats.readBacks += asked.readBacks + metered.readBacks;
  stats.of(EffectId::Redraw) += asked.draws;
  if (results.surfaces.finish) stats.of(EffectId::Glossy) += asked.draws;
  stats.wallMs += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return stats;
}

const FrameStats& Viewer::stats() const { return passes_->stats; }

// Looking at it -------------------------------------------------------------------------------------------------------

namespace {
const std::vector<std::string> kBufferNames = {"beauty",      "direct",  "indirect",  "irradiance", "albedo",
                                               "normal",      "depth",   "emission",  "unfiltered", "vpls",
                                               "shadow-maps", "patches", "fragments", "nan"};
}

static_assert(size_t(Buffer::Nan) + 1 == 14, "a name for each");
const std::vector<std::string>& bufferNames() { return kBufferNames; }

Buffer bufferByName(const std::string& name) {
  for (size_t i = 0; i < kBufferNames.size(); ++i)
    if (kBufferNames[i] == name) return Buffer(i);
  throw InputError("--buffer " + name, "no such buffer (" + guessText(name, kBufferNames, joined(kBufferNames)) + ")");
}

Image Viewer::read(Buffer buffer) const {
  const gl::StateGuard guard;
  return passes_->results.surfaces.depth ? readBuffer(buffer, passes_->results) : Image();
}

uint32_t Viewer::texture(Buffer buffer) const {
  const FrameResults& r = passes_->results;
  const auto name = [](const gl::Texture* texture) { return texture ? texture->name() : 0; };
  if (!r.radiance) return 0;
  switch (buffer) {
  case Buffer::Beauty:
    return name(r.radiance);
  case Buffer::Irradiance:
    return name(r.indirect.irradiance);
  case Buffer::Albedo:
    return name(r.surfaces.albedo);
  case Buffer::Normal:
    return name(r.surfaces.normal);
  case Buffer::Emission:
    return name(r.surfaces.emission);
  case Buffer::Direct:
  case Buffer::Indirect: {
    const gl::StateGuard guard;
    const bool direct = buffer == Buffer::Direct;
    return name(&passes_->part.run({.surfaces = r.surfaces,
                                    .direct = direct ? r.direct : SurfaceLighting{},
                                    .indirect = direct ? SurfaceLighting{} : r.indirect,
                                    .sky = direct ? r.sky : Sky{},
                                    .emission = direct}));
  }
  default:
    return 0;
  }
}

/// Draws the buffer as a display shows it.
bool Viewer::show(Buffer buffer) const {
  if (!passes_->results.radiance) return false;
  if (buffer == Buffer::Vpls) gi_.vpls(); // an update takes the set away
  passes_->display.run(buffer, passes_->results, look());
  return true;
}

Image8 Viewer::readDisplay(Buffer buffer) const {
  const gl::StateGuard guard;
  return show(buffer) ? passes_->display.read() : Image8();
}

void Viewer::present(Buffer buffer, uint32_t framebuffer, int width, int height) const {
  const gl::StateGuard guard;
  if (show(buffer)) passes_->display.present(framebuffer, width, height);
}

void Viewer::takeTruth(const Image& truth) {
  const gl::StateGuard guard;
  passes_->truth.take(truth, passes_->results);
}

void Viewer::presentBesideTruth(Buffer buffer, float divider, uint32_t framebuffer, int width, int height) const {
  const gl::StateGuard guard;
  if (!passes_->results.radiance) return;
  const gl::Texture& truth = passes_->truth.run(buffer, passes_->results, look());
  show(buffer);
  passes_->display.present(framebuffer, width, height, &truth, divider);
}

void Viewer::presentError(Buffer buffer, float full, uint32_t framebuffer, int width, int height) const {
  const gl::StateGuard guard;
  if (!passes_->results.radiance) return;
  passes_->display.run(buffer, passes_->results, look(), {&passes_->truth.linear(), full});
  passes_->display.present(framebuffer, width, height);
}

Look Viewer::look() const {
  const Settings& s = gi_.settings();
  return {exposure_, s.image.toneMapper, s.debug.nan, s.image.antiAliasing};
}

} // namespace lambent
