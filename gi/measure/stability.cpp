#include "gi/measure/stability.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>

namespace lambent {

float toneMappedLuminance(const vec3& radiance, float exposure) {
  const float y = exposure * luminance(radiance);
  return y / (1 + y);
}

double toneMappedVariance(const vec3& radiance, const vec3& error, float exposure) {
  const double x = exposure * luminance(radiance);
  const double e = exposure * luminance(error) / ((1 + x) * (1 + x));
  return e * e;
}

PixelSeries toneMappedSeries(std::span<const std::vector<TrackedValue>> values,
                             const std::vector<std::vector<bool>>& seen, float exposure) {
  PixelSeries out(values.size());
  for (size_t f = 0; f < values.size(); ++f)
    for (size_t i = 0; i < values[f].size(); ++i)
      out[f].push_back(seen[f][i] ? toneMappedLuminance(values[f][i].radiance, exposure) : std::nanf(""));
  return out;
}

StabilityErrors stabilityErrors(const PixelSeries& technique, const PixelSeries& truth,
                                std::span<const uint32_t> pixels) {
  CHECK_EQ(technique.size(), truth.size());
  StabilityErrors out;
  double error = 0, change = 0, bias = 0;
  size_t changes = 0;
  for (size_t t = 0; t < truth.size(); ++t)
    for (uint32_t p : pixels) {
      const double e = double(technique[t][p]) - truth[t][p];
      if (std::isnan(e)) continue;
      error += std::abs(e);
      bias += e;
      ++out.count;
      if (t == 0) continue;
      const double before = double(technique[t - 1][p]) - truth[t - 1][p];
      if (std::isnan(before)) continue;
      change += std::abs(e - before);
      ++changes;
    }
  if (out.count) out.error = error / double(out.count), out.bias = bias / double(out.count);
  if (changes) out.change = change / double(changes);
  return out;
}

Latency latency90(const PixelSeries& technique, const PixelSeries& truth, std::span<const uint32_t> pixels,
                  std::span<const size_t> steps, float least) {
  CHECK_EQ(technique.size(), truth.size());
  std::vector<double> frames;
  double own = 0, wanted = 0;
  for (size_t s = 0; s < steps.size(); ++s) {
    const size_t begin = steps[s], end = s + 1 < steps.size() ? steps[s + 1] : truth.size();
    if (begin == 0 || begin >= end) continue;
    const size_t settled = std::max<size_t>(1, (end - begin) / 4);
    for (uint32_t p : pixels) {
      const double change = double(truth[begin][p]) - truth[begin - 1][p];
      if (!(std::abs(change) >= least)) continue;
      double last = 0;
      for (size_t t = end - settled; t < end; ++t) last += technique[t][p] / double(settled);
      const double before = technique[begin - 1][p], whole = last - before;
      own += std::copysign(1.0, change) * whole;
      wanted += std::abs(change);
      if (!(std::abs(whole) > 0)) { // it does not follow at all
        frames.push_back(double(end - begin));
        continue;
      }
      size_t t = begin;
      while (t < end && (technique[t][p] - before) / whole < 0.9) ++t;
      frames.push_back(double(t - begin));
    }
  }
  Latency out;
  out.count = frames.size();
  if (frames.empty()) return out;
  out.followed = own / wanted;
  std::sort(frames.begin(), frames.end());
  out.median = frames[frames.size() / 2];
  out.worstTenth = frames[std::min(frames.size() - 1, frames.size() * 9 / 10)];
  return out;
}

bool jumped(const InstanceView& instance, const Aabb& boundsObject) {
  if (!instance.moved || boundsObject.empty()) return false;
  float farthest = 0;
  for (int i = 0; i < 8; ++i) {
    const vec3 corner = glm::mix(boundsObject.lo, boundsObject.hi, vec3(i & 1, i >> 1 & 1, i >> 2 & 1));
    const vec3 now = vec3(instance.worldFromObject * vec4(corner, 1));
    farthest = std::max(farthest, glm::length(now - vec3(instance.worldFromObjectBefore * vec4(corner, 1))));
  }
  return farthest > 0 && farthest >= 0.25f * instance.boundsWorld.diameter();
}

bool StepFinder::step(const SceneView& view) {
  bool found = false;
  for (const InstanceView& i : view.instances) found |= jumped(i, view.assets->meshes[i.mesh].boundsObject);
  std::vector<float> now;
  for (const LightView& l : view.lights) now.push_back(luminance(l.intensity));
  for (size_t i = 0; i < now.size() && now.size() == before_.size(); ++i)
    found |= std::min(now[i], before_[i]) < 0.5f * std::max(now[i], before_[i]);
  before_ = std::move(now);
  return found;
}

} // namespace lambent
