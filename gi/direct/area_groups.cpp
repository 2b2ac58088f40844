#include "gi/direct/area_groups.h"

#include "engine/core/rng.h"

#include <cmath>
#include <numeric>

namespace lambent {

namespace {

/// Some of the lights, with what is theirs.
AreaLights only(const AreaLights& all, std::span<const uint32_t> which, std::span<const double> brought) {
  AreaLights some;
  for (const uint32_t l : which) {
    AreaLight light = all.lights[l];
    const std::span pieces = std::span(all.pieces).subspan(light.firstPiece, light.pieces);
    const std::span samples = std::span(all.samples).subspan(light.firstSample, light.samples);
    light.brought = float(brought[l]);
    light.firstPiece = uint32_t(some.pieces.size());
    light.firstSample = uint32_t(some.samples.size());
    some.pieces.insert(some.pieces.end(), pieces.begin(), pieces.end());
    some.samples.insert(some.samples.end(), samples.begin(), samples.end());
    some.lights.push_back(light);
  }
  return some;
}

} // namespace

std::vector<AreaLights> AreaGroups::of(const AreaLights& lights, const RayQuery& rays, const FrameSurfaces& surfaces,
                                       RayCounts& counts) {
  constexpr size_t kTests = 1 << 15, kMostPixels = 256, kLeastPixels = 32;
  constexpr double kAlike = 16;    // as bright
  constexpr double kBeyond = 0.25; // of a group's width (a factor of two) that a light goes past it before it leaves
  constexpr int kBands = 3;
  const size_t count = lights.lights.size();
  if (bands_.size() != count) {
    bands_.assign(count, -1);
    scale_ = 0;
  }
  if (count < 2) return {lights};
  const std::vector<glm::ivec2> pixels = surfaces.some(std::clamp(kTests / count, kLeastPixels, kMostPixels));
  const AreaVisibility visibility(rays, lights, surfaces, 1);
  std::vector<double> brought(count, 0);
  std::vector<std::pair<uint32_t, Ray>> asked; // light, ray
  for (const glm::ivec2& pixel : pixels) visibility.askEach(pixel, brought, asked);
  std::vector<Ray> segments;
  for (const auto& [light, ray] : asked) segments.push_back(ray);
  std::vector<uint8_t> blocked(segments.size());
  rays.occluded(segments, blocked);
  counts.occlusion += segments.size();
  std::vector<bool> seen(count, false);
  for (size_t i = 0; i < asked.size(); ++i)
    if (!blocked[i]) seen[asked[i].first] = true;

  double brightest = 0;
  for (size_t l = 0; l < count; ++l)
    if (seen[l]) brightest = std::max(brightest, brought[l]);
  if (brightest > scale_ || brightest * kAlike * kAlike < scale_)
    scale_ = brightest; // one that is out of sight may come back
  std::array<std::vector<uint32_t>, kBands + 1> groups;
  for (uint32_t l = 0; l < count; ++l) {
    if (!seen[l]) {
      groups[kBands].push_back(l);
      continue;
    }
    const double steps = std::log(scale_ / brought[l]) / std::log(kAlike);
    const bool stays = bands_[l] >= 0 && std::abs(steps - (bands_[l] + 0.5)) < 0.5 + kBeyond;
    if (!stays) bands_[l] = std::min(int(steps), kBands - 1);
    groups[size_t(bands_[l])].push_back(l);
  }
  std::vector<AreaLights> out;
  for (const std::vector<uint32_t>& group : groups)
    if (!group.empty()) out.push_back(only(lights, group, brought));
  return out;
}

} // namespace lambent
