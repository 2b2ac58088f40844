#include "gi/reference/traced_image.h"

#include "engine/core/open_watch.h"
#include "engine/image/exposure.h"
#include "engine/trace/embree_query.h"
#include "gi/reference/state_file.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace lambent {

namespace {

using Clock = std::chrono::steady_clock;

// Fewer samples do not tell their own error.
constexpr uint32_t kSamplesToJudge = 16;

/// Samples until enough are taken, the error is reached or it is cancelled; saves the state as it goes.
ReferenceSums sampled(const TracePlan& plan, const ReferenceInputs& in, uint64_t key, TracedImage& out) {
  ReferenceSums sums(in.camera.width, in.camera.height);
  if (!plan.state.empty() && std::filesystem::exists(plan.state)) sums = loadReference(plan.state, in, key);
  uint32_t saved = sums.samples;
  const auto save = [&] {
    // Of two programs with one state, that with fewer samples leaves the other's.
    if (!plan.state.empty() && saved != sums.samples && samplesIn(plan.state, in, key) <= sums.samples)
      saveReference(plan.state, sums, key);
    saved = sums.samples;
  };
  // A pass takes about a second: progress moves, and a wish to stop is heard.
  const uint32_t perPass = uint32_t(std::clamp<size_t>((1 << 19) / sums.pixels.size(), 1, 64));
  auto lastSave = Clock::now();
  Clock::duration saving{}; // what the last took
  const uint32_t before = sums.samples;
  double seconds = 0;
  while (sums.samples < plan.samples && !(plan.cancelled && plan.cancelled())) {
    double expected = plan.samples;
    if (plan.error > 0 && sums.samples >= kSamplesToJudge) {
      const double error = readReference(sums, in, plan.buffer).relativeError;
      if (error <= plan.error) break;
      expected = std::min(expected, sums.samples * std::pow(error / plan.error, 2)); // it falls with the root
    }
    const auto start = Clock::now();
    const ReferenceSums whole = in.stopped ? sums : ReferenceSums();
    addSamples(sums, in, std::min(perPass, plan.samples - sums.samples), out.rays);
    if (in.stopped && *in.stopped) {
      sums = whole;
      break;
    }
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    if (plan.progress) plan.progress(int(sums.samples), int(std::max<double>(sums.samples, expected)));
    // Killed, it loses a second, or as much more as keeps the time to save below a twentieth.
    if (const auto now = Clock::now();
        now - lastSave > std::max<Clock::duration>(std::chrono::seconds(1), 20 * saving)) {
      save();
      lastSave = Clock::now();
      saving = lastSave - now;
    }
  }
  save();
  out.samples = sums.samples;
  if (sums.samples > before) out.sampleSeconds = seconds / (sums.samples - before);
  return sums;
}

} // namespace

bool tracesGlossy(const SceneView& view, const Settings& settings, ReferenceBuffer buffer) {
  return settings.gather.glossy && settings.effects[EffectId::Glossy] != EffectMode::Off &&
         buffer != ReferenceBuffer::Irradiance && view.assets &&
         std::ranges::any_of(view.assets->materials, &Material::glossy);
}

bool mixesBlended(const SceneView& view, ReferenceBuffer buffer) {
  return buffer != ReferenceBuffer::Irradiance && view.assets && view.assets->blends() && !view.camera.throughBlended;
}

bool tracesNormalMaps(const SceneView& view, const Settings& settings) {
  return settings.effects[EffectId::NormalMaps] != EffectMode::Off && view.assets &&
         std::ranges::any_of(view.assets->materials, [](const Material& m) { return m.normalTexture.image != kNone; });
}

TracedImage traceImage(const SceneView& view, const Settings& settings, const TracePlan& plan) {
  EmbreeQuery rays(*view.assets);
  rays.update(view);
  const LightSet lights = collectLights(view);
  const ReferenceInputs in{.rays = rays,
                           .lights = lights,
                           .camera = view.camera,
                           .bounces = settings.smc.bounces,
                           .clamp = plan.clamped ? settings.gather.clamp : 0,
                           .seed = plan.seed,
                           .glossy = tracesGlossy(view, settings, plan.buffer) ? &view : nullptr,
                           .normalMaps = tracesNormalMaps(view, settings) ? &view : nullptr,
                           .blended = view.assets->blends() ? &view : nullptr,
                           .mixes = mixesBlended(view, plan.buffer),
                           .stopped = plan.stopped};
  TracedImage out{.bounces = in.bounces, .clamp = in.clamp};
  OpenWatch::end(); // paths take what they are asked for
  const ReferenceSums sums = sampled(plan, in, referenceKey(view, in), out);
  if (out.samples == 0) return out;
  out.image = readReference(sums, in, plan.buffer);
  out.exposure = settings.image.exposure;
  if (out.exposure <= 0) {
    const ReferenceImage beauty = readReference(sums, in, ReferenceBuffer::Beauty);
    std::vector<vec3> seen;
    for (size_t i = 0; i < beauty.surface.size(); ++i)
      if (beauty.surface[i]) seen.push_back(beauty.mean.pixels[i]);
    out.exposure = exposureFor(seen);
  }
  return out;
}

} // namespace lambent
