#include "gi/render/map_schedule.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// Whether some of up to `tries` points of the box are in sight, as far as the place where the ray enters it. The
/// points are spread evenly (Roberts' R3 sequence, randomly shifted), so that a part in sight is found though it is
/// small.
bool seesPlace(const vec3& origin, const vec3& normal, const Aabb& box, const RayQuery& rays, Rng& rng, int tries,
               RayCounts& counts) {
  const vec3 shift(rng.next(), rng.next(), rng.next());
  for (int i = 0; i < tries; ++i) {
    const vec3 to = box.lo + box.size() * glm::fract(shift + float(i) * vec3(0.8191725f, 0.6710436f, 0.5497005f));
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
        if (stale_[i].texels == TexelRect::whole(resolution)) break;
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
  // The error of a map grows with its light and with the frames it has waited, so the mean error of all is least when
  // light b waits for frames in proportion to 1/√b, whatever the area: the one with most b · frames² is next (as in
  // Kadota et al. 2018, "Scheduling policies for minimizing age of information", where it is Whittle's index). Light
  // below a share of the mean counts as that share, so that no map waits for ever.
  constexpr double kLeastShare = 1.0 / 256;
  double sum = 0;
  size_t lights = 0;
  for (const float b : brightness)
    if (b > 0) sum += b, ++lights;
  const float least = lights ? float(kLeastShare * sum / double(lights)) : 0;
  const auto urgency = [&](uint32_t slot) {
    return std::max(brightness[slot], least) * float(stale_[slot].frames) * float(stale_[slot].frames);
  };
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < stale_.size(); ++i) {
    if (brightness[i] <= 0) stale_[i] = {}; // an empty slot
    if (stale_[i].texels.empty()) continue;
    ++stale_[i].frames;
    order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return urgency(a) > urgency(b); });
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
