#include "gi/render/map_schedule.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "shaders/shared/paraboloid.h"

#include <algorithm>
#include <cmath>

namespace lambent {

// The paraboloid map is a stereographic projection: uv of polar angle t lies at tan(t/2)/2 from the centre, and circles
// on the sphere are circles in the map. So the sphere around a box covers a disc, found from its nearest and farthest
// polar angle.
TexelRect texelsCovered(const MapPose& pose, const Aabb& box, int resolution) {
  const vec3 origin = offsetPoint(pose.position, pose.geometricNormal);
  const vec3 d = box.centre() - origin;
  const float radius = 0.5f * box.diameter(), distance = glm::length(d);
  if (!(distance > radius * 1.001f)) return TexelRect::whole(resolution);
  vec3 tangent, bitangent;
  basisAround(pose.normal, tangent, bitangent);
  const vec3 local = vec3(glm::dot(d, tangent), glm::dot(d, bitangent), glm::dot(d, pose.normal)) / distance;
  const float polar = std::acos(glm::clamp(local.z, -1.0f, 1.0f)), half = std::asin(radius / distance);
  constexpr float kHorizon = 0.5f * kPi + 0.05f; // texels reach a little below it
  if (polar - half > kHorizon) return {};
  const float outer = std::min(polar + half, 0.95f * kPi); // beyond the map long before
  const float r0 = 0.5f * std::tan(0.5f * (polar - half)), r1 = 0.5f * std::tan(0.5f * outer);
  const vec2 flat(local.x, local.y);
  const float length = glm::length(flat);
  const vec2 along = length > 1e-6f ? flat / length : vec2(1, 0);
  const vec2 centre = 0.5f + along * (0.5f * (r0 + r1));
  const float discRadius = 0.5f * (r1 - r0);
  const vec2 lo = (centre - discRadius) * float(resolution), hi = (centre + discRadius) * float(resolution);
  const auto bound = [resolution](float v) { return int(glm::clamp(v, 0.0f, float(resolution))); };
  return {bound(std::floor(lo.x) - 1), bound(std::floor(lo.y) - 1), bound(std::ceil(hi.x) + 1),
          bound(std::ceil(hi.y) + 1)};
}

namespace {

/// Whether some of up to `tries` random points of the box are in sight, as far as the place where the ray enters it.
bool seesPlace(const vec3& origin, const vec3& normal, const Aabb& box, const RayQuery& rays, Rng& rng, int tries,
               RayCounts& counts) {
  for (int i = 0; i < tries; ++i) {
    const vec3 to = box.lo + box.size() * vec3(rng.next(), rng.next(), rng.next());
    const vec3 d = to - origin;
    if (glm::dot(d, normal) <= 0) continue;
    float enter = 0;
    for (int a = 0; a < 3; ++a)
      if (std::abs(d[a]) > 1e-30f)
        enter = std::max(enter, std::min((box.lo[a] - origin[a]) / d[a], (box.hi[a] - origin[a]) / d[a]));
    ++counts.occlusion;
    if (enter <= 0 || !rays.occluded(Ray{origin, d, enter})) return true;
  }
  return false;
}

} // namespace

void MapSchedule::disturb(std::span<const MapPose> poses, std::span<const float> brightness, const Disturbance& moved,
                          const RayQuery& rays, int resolution, int raysPerBox, uint32_t seed, uint32_t frame,
                          RayCounts& counts) {
  stale_.resize(poses.size());
  constexpr size_t kGrain = 64;
  // With many movers rays would take longer than the maps; a light that has tried so many counts as seeing the rest.
  constexpr int kBoxesTested = 8;
  std::vector<RayCounts> perBlock((poses.size() + kGrain - 1) / kGrain);
  parallelFor(poses.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (brightness[i] <= 0) continue;
      const vec3 origin = offsetPoint(poses[i].position, poses[i].geometricNormal);
      Rng rng(seed, Stream::MapTests, uint32_t(i), frame);
      int tested = 0;
      for (const Aabb& box : moved.boxes()) {
        const TexelRect texels = texelsCovered(poses[i], box, resolution);
        TexelRect all = stale_[i].texels;
        all.add(texels);
        if (texels.empty() || all == stale_[i].texels) continue; // behind it, or listed already
        if (raysPerBox > 0 && tested++ < kBoxesTested &&
            !seesPlace(origin, poses[i].geometricNormal, box, rays, rng, raysPerBox, perBlock[begin / kGrain]))
          continue;
        stale_[i].texels = all;
      }
    }
  });
  for (const RayCounts& c : perBlock) counts += c;
}

void MapSchedule::disturbInTurn(size_t slots, size_t count, int resolution) {
  stale_.resize(slots);
  for (size_t i = 0; i < std::min(count, slots); ++i) stale_[turn_++ % slots].texels = TexelRect::whole(resolution);
}

void MapSchedule::disturbAll(size_t slots, int resolution) {
  stale_.resize(slots);
  for (Stale& s : stale_) s.texels = TexelRect::whole(resolution);
}

std::vector<MapJob> MapSchedule::take(std::span<const uint32_t> first, std::span<const float> brightness,
                                      int resolution, int64_t texels) {
  stale_.resize(brightness.size());
  std::vector<MapJob> jobs;
  for (uint32_t slot : first) {
    jobs.push_back({slot, TexelRect::whole(resolution)});
    stale_[slot] = {};
  }
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < stale_.size(); ++i) {
    if (brightness[i] <= 0) stale_[i] = {}; // an empty slot
    if (stale_[i].texels.empty()) continue;
    ++stale_[i].frames;
    order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return brightness[a] * float(stale_[a].frames) > brightness[b] * float(stale_[b].frames);
  });
  for (uint32_t slot : order) {
    if (texels <= 0) break;
    texels -= stale_[slot].texels.area();
    jobs.push_back({slot, stale_[slot].texels});
    stale_[slot] = {};
  }
  std::sort(jobs.begin(), jobs.end(), [](const MapJob& a, const MapJob& b) { return a.slot < b.slot; });
  return jobs;
}

size_t MapSchedule::waiting() const {
  return size_t(std::count_if(stale_.begin(), stale_.end(), [](const Stale& s) { return !s.texels.empty(); }));
}

} // namespace lambent
