#include "gi/near/near_memory.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr float kGuess = 0.5f;                  // share where a surface comes into sight
constexpr float kFresh = 2;                     // and how many times its weight there
constexpr float kLeastShare = 1 / 64.0f;        // of what may only have been missed
constexpr float kLeastRays = 0.5f, kMostRays = 16; // fewer leave bright spots
constexpr float kKnown = 8;                     // rays that a share is worth at most
constexpr float kOnPlane = 1;                   // deviation from a pixel's plane, pixels
constexpr float kAlike = 0.3f;                  // cosine between normals

} // namespace

void NearMemory::fit(const CameraView& seenBy) {
  const size_t pixels = size_t(seenBy.width) * size_t(seenBy.height);
  camera = seenBy;
  positions.assign(pixels, vec3(kInfinity));
  normals.assign(pixels, vec3(0));
  near.assign(pixels, 0);
}

NearRates::NearRates(const NearMemory& before, float budget)
    : before_(before), clipFromWorld_(clipFromView(before.camera) * glm::inverse(before.camera.worldFromView)),
      budget_(budget), rate_(before.rate > 0 ? before.rate : budget) {}

NearRates::Rate NearRates::at(const SurfaceHit& surface) const {
  const float* near = nearOf(surface);
  const float share = near ? *near : kGuess;
  const float weight = std::sqrt(std::max(share, kLeastShare)) * (near ? 1 : kFresh);
  return {std::clamp(weight * rate_, std::min(kLeastRays, budget_), std::max(kMostRays, budget_)), share,
          near ? kKnown : 1};
}

float NearRates::next(uint64_t rays, size_t pixels) const {
  const float wanted = budget_ * float(pixels);
  return rays > 0 ? std::clamp(rate_ * wanted / float(rays), budget_ / 16, budget_ * 16) : rate_;
}

const float* NearRates::nearOf(const SurfaceHit& surface) const {
  if (!(before_.rate > 0)) return nullptr;
  const CameraView& camera = before_.camera;
  const vec4 clip = clipFromWorld_ * vec4(surface.position, 1);
  if (!(clip.w > 0)) return nullptr;
  const vec2 at = (vec2(clip.x, -clip.y) / clip.w * 0.5f + 0.5f) * vec2(camera.width, camera.height);
  if (!(at.x >= 0 && at.y >= 0 && at.x < float(camera.width) && at.y < float(camera.height))) return nullptr;
  const size_t pixel = size_t(at.y) * size_t(camera.width) + size_t(at.x);
  const float half = camera.orthoHalfHeight > 0 ? camera.orthoHalfHeight : std::tan(camera.fovY / 2) * clip.w;
  const float off = glm::dot(before_.positions[pixel] - surface.position, surface.normal);
  const bool same = std::abs(off) <= kOnPlane * 2 * half / float(camera.height) &&
                    glm::dot(before_.normals[pixel], surface.normal) >= kAlike;
  return same ? &before_.near[pixel] : nullptr;
}

} // namespace lambent
