#include "gi/reference/traced_picture.h"

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
class Tracing {
 public:
  Tracing(const TracePlan& plan, const ReferenceInputs& in, uint64_t key)
      : plan_(plan), in_(in), key_(key), sums_(in.camera.width, in.camera.height) {
    if (!plan.state.empty() && std::filesystem::exists(plan.state)) sums_ = loadReference(plan.state, in, key);
    saved_ = sums_.samples;
  }

  void sample() {
    // A pass takes about a second: progress moves, and a wish to stop is heard.
    const size_t perPass = std::clamp<size_t>((1 << 19) / sums_.pixels.size(), 1, 64);
    auto lastSave = Clock::now();
    while (sums_.samples < plan_.samples && !(plan_.cancelled && plan_.cancelled())) {
      const double error = plan_.error > 0 && sums_.samples >= kSamplesToJudge
                               ? readReference(sums_, in_, plan_.buffer).relativeError
                               : double(kInfinity);
      if (error <= plan_.error) break;
      addSamples(sums_, in_, std::min<uint32_t>(uint32_t(perPass), plan_.samples - sums_.samples), rays_);
      if (plan_.progress) plan_.progress(int(sums_.samples), samplesExpected(error));
      if (Clock::now() - lastSave > std::chrono::seconds(60)) {
        save();
        lastSave = Clock::now();
      }
    }
    save();
  }

  const ReferenceSums& sums() const { return sums_; }
  const RayCounts& rays() const { return rays_; }

 private:
  /// Error falls with the root of the number of samples.
  int samplesExpected(double error) const {
    const double forError = std::isfinite(error) ? sums_.samples * std::pow(error / plan_.error, 2) : 1e9;
    return int(std::max<double>(sums_.samples, std::min<double>(plan_.samples, forError)));
  }

  void save() {
    if (plan_.state.empty() || saved_ == sums_.samples) return;
    saveReference(plan_.state, sums_, key_);
    saved_ = sums_.samples;
  }

  const TracePlan& plan_;
  const ReferenceInputs& in_;
  const uint64_t key_;
  ReferenceSums sums_;
  RayCounts rays_;
  uint32_t saved_ = 0;
};

float measuredExposure(const ReferencePicture& beauty) {
  std::vector<vec3> seen;
  for (size_t i = 0; i < beauty.surface.size(); ++i)
    if (beauty.surface[i]) seen.push_back(beauty.mean.pixels[i]);
  return exposureFor(seen);
}

} // namespace

float exposureFor(std::span<const vec3> radiance) {
  double sum = 0;
  size_t count = 0;
  for (const vec3& r : radiance) {
    const float y = luminance(r);
    if (y > 0 && std::isfinite(y)) sum += std::log(double(y)), ++count;
  }
  return count ? float(0.18 / std::exp(sum / double(count))) : 1.0f;
}

TracedPicture tracePicture(const SceneView& view, const Settings& settings, const TracePlan& plan) {
  EmbreeQuery rays(*view.assets);
  rays.update(view);
  const LightSet lights = collectLights(view);
  const bool glossy = settings.gather.glossy && settings.effects[EffectId::Glossy] != EffectMode::Off &&
                      plan.buffer != ReferenceBuffer::Irradiance;
  const ReferenceInputs in{.rays = rays,
                           .lights = lights,
                           .camera = view.camera,
                           .bounces = settings.smc.bounces,
                           .clamp = plan.clamped ? settings.gather.clamp : 0,
                           .seed = plan.seed,
                           .glossy = glossy ? &view : nullptr};
  Tracing tracing(plan, in, referenceKey(view, in));
  tracing.sample();
  TracedPicture out;
  out.samples = tracing.sums().samples;
  out.bounces = in.bounces;
  out.clamp = in.clamp;
  out.rays = tracing.rays();
  if (out.samples == 0) return out;
  out.picture = readReference(tracing.sums(), in, plan.buffer);
  out.exposure = settings.image.exposure > 0
                     ? settings.image.exposure
                     : measuredExposure(readReference(tracing.sums(), in, ReferenceBuffer::Beauty));
  return out;
}

} // namespace lambent
