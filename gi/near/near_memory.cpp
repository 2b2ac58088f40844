#include "gi/near/near_memory.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr float kGuess = 0.5f;                     // share where a surface comes into sight
constexpr float kFresh = 2;                        // and how many times its weight there
constexpr float kLeastShare = 1 / 64.0f;           // of what may only have been missed
constexpr float kLeastRays = 0.5f, kMostRays = 16; // fewer leave bright spots
constexpr float kKnown = 8;                        // rays that a share found before is worth
constexpr float kLightKept = 15 / 16.0f;           // of a pixel's mean, each frame
constexpr float kOnPlane = 1;                      // deviation from a pixel's plane, pixels
constexpr float kAlike = 0.3f;                     // cosine between normals

} // namespace

void NearMemory::fit(const CameraView& seenBy) {
  const size_t pixels = size_t(seenBy.width) * size_t(seenBy.height);
  camera = seenBy;
  positions.assign(pixels, vec3(kInfinity));
  normals.assign(pixels, vec3(0));
  near.assign(pixels, 0);
  light.assign(pixels, 0);
}

void NearMemory::keep(size_t pixel, const NearExpected& before, uint32_t cast, uint32_t brought, float found) {
  near[pixel] = (before.near * before.worthRays + float(brought)) / std::max(before.worthRays + float(cast), 1.0f);
  light[pixel] = std::isfinite(found) ? glm::mix(found, before.light, kLightKept) : before.light;
}

NearRates::NearRates(const NearMemory& before, std::span<const SurfaceHit> surfaces, float budget)
    : before_(before), clipFromWorld_(clipFromView(before.camera) * glm::inverse(before.camera.worldFromView)),
      budget_(budget), rate_(budget) {
  std::vector<float> weights;
  for (const SurfaceHit& h : surfaces)
    if (h.valid()) weights.push_back(weightOf(pixelOf(h)));
  constexpr int kRounds = 8; // bounds make it a fixed point, that comes near soon
  for (int i = 0; i < kRounds && !weights.empty(); ++i) {
    double rays = 0;
    for (const float w : weights) rays += double(raysOf(w));
    rate_ *= budget * float(weights.size()) / float(rays);
  }
}

NearExpected NearRates::at(const SurfaceHit& surface) const {
  const std::optional<size_t> pixel = pixelOf(surface);
  const float rays = raysOf(weightOf(pixel));
  if (!pixel) return {rays, kGuess, 1, 0};
  return {rays, before_.near[*pixel], kKnown, before_.light[*pixel]};
}

float NearRates::weightOf(std::optional<size_t> pixel) const {
  return pixel ? std::sqrt(std::max(before_.near[*pixel], kLeastShare)) : kFresh * std::sqrt(kGuess);
}

float NearRates::raysOf(float weight) const {
  return std::clamp(weight * rate_, std::min(kLeastRays, budget_), std::max(kMostRays, budget_));
}

std::optional<size_t> NearRates::pixelOf(const SurfaceHit& surface) const {
  if (before_.positions.empty()) return {};
  const CameraView& camera = before_.camera;
  const vec4 clip = clipFromWorld_ * vec4(surface.position, 1);
  if (!(clip.w > 0)) return {};
  const vec2 at = (vec2(clip.x, -clip.y) / clip.w * 0.5f + 0.5f) * vec2(camera.width, camera.height);
  if (!(at.x >= 0 && at.y >= 0 && at.x < float(camera.width) && at.y < float(camera.height))) return {};
  const size_t pixel = size_t(at.y) * size_t(camera.width) + size_t(at.x);
  const float half = camera.orthoHalfHeight > 0 ? camera.orthoHalfHeight : std::tan(camera.fovY / 2) * clip.w;
  const float off = glm::dot(before_.positions[pixel] - surface.position, surface.normal);
  const bool same = std::abs(off) <= kOnPlane * 2 * half / float(camera.height) &&
                    glm::dot(before_.normals[pixel], surface.normal) >= kAlike;
  return same ? std::optional(pixel) : std::nullopt;
}

} // namespace lambent
