#include "gi/visibility/map_schedule.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lambent {

namespace {

constexpr int kRough = 2; // texels between the rays of a map that is drawn coarsely while others wait

/// Whether some of up to `tries` points of the box are in sight, as far as the place where the ray enters it. The
/// points are spread evenly (Roberts' R3 sequence, randomly shifted), so that a part in sight is found though it is
/// small.
bool seesPlace(const vec3& origin, const vec3& normal, const Aabb& box, const RayQuery& rays, Rng& rng, int tries,
               RayCounts& counts) {
  const vec3 shift = rng.next3();
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

/// Share of a diffuse light's flux per texel, on the mean over some texels of the rectangle: towards the horizon texels
/// are smaller and carry less. Up to a constant factor.
float fluxPerTexel(const TexelRect& texels, int resolution) {
  constexpr int kSamples = 4; // per side
  float sum = 0;
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const vec2 at = (vec2(i % kSamples, i / kSamples) + 0.5f) / float(kSamples);
    const vec2 texel = glm::mix(vec2(texels.x0, texels.y0), vec2(texels.x1, texels.y1), at);
    const vec2 p = 2.0f * texel / float(resolution) - 1.0f;
    const float r2 = glm::dot(p, p);
    // cos = (1 - r²) / (1 + r²), solid angle ∝ 1 / (1 + r²)²
    sum += std::max(0.0f, 1 - r2) / ((1 + r2) * (1 + r2) * (1 + r2));
  }
  return sum / float(kSamples * kSamples);
}

} // namespace

void MapSchedule::invalidate(std::span<const MapPose> poses, std::span<const float> brightness,
                             const DirtyRegion& moved, const RayQuery& rays, int resolution, int raysPerBox,
                             uint32_t seed, uint32_t frame, RayCounts& counts) {
  stale_.resize(poses.size());
  constexpr size_t kGrain = 64;
  // With many movers rays would take longer than the maps; a light that has tried so many counts as seeing the rest.
  constexpr int kBoxesTested = 8;
  // A map that is stale for the most part is drawn whole: among hundreds of movers looking on would take longer.
  // Neighbours lie together in the list, so it is gone through in strides, which fill the map sooner.
  constexpr float kMost = 0.75f;
  const std::span<const Aabb> boxes = moved.boxes();
  size_t stride = std::max<size_t>(1, size_t(0.618 * double(boxes.size())));
  while (std::gcd(stride, boxes.size()) > 1) ++stride;
  parallelCount(poses.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    for (size_t i = begin; i < end; ++i) {
      if (brightness[i] <= 0) continue;
      const vec3 origin = poses[i].origin();
      Rng rng(seed, Stream::MapTests, uint32_t(i), frame);
      int tested = 0;
      for (size_t j = 0; j < boxes.size(); ++j) {
        const Aabb& box = boxes[j * stride % boxes.size()];
        if (stale_[i].texels.area() > kMost * float(resolution * resolution)) {
          stale_[i].texels = TexelRect::whole(resolution);
          break;
        }
        const TexelRect texels = texelsCovered(poses[i], box, resolution);
        TexelRect all = stale_[i].texels;
        all.add(texels);
        if (texels.empty() || all == stale_[i].texels) continue; // behind it, or listed already
        if (raysPerBox > 0 && tested++ < kBoxesTested &&
            !seesPlace(origin, poses[i].geometricNormal, box, rays, rng, raysPerBox, count))
          continue;
        stale_[i].texels = all;
      }
    }
  });
}

void MapSchedule::invalidateInTurn(size_t slots, size_t count, int resolution) {
  stale_.resize(slots);
  for (size_t i = 0; i < std::min(count, slots); ++i) stale_[turn_++ % slots].texels = TexelRect::whole(resolution);
}

void MapSchedule::invalidateWhole(std::span<const uint32_t> which, size_t slots, int resolution) {
  stale_.resize(slots);
  for (uint32_t slot : which) stale_[slot].texels = TexelRect::whole(resolution);
}

void MapSchedule::invalidateAll(size_t slots, int resolution) {
  stale_.resize(slots);
  for (Stale& s : stale_) s.texels = TexelRect::whole(resolution);
}

void MapSchedule::drawnCoarsely(std::span<const MapJob> jobs, size_t slots) {
  stale_.assign(slots, {});
  for (const MapJob& job : jobs) (job.step > kRough ? stale_[job.slot].texels : stale_[job.slot].rough) = job.texels;
}

std::vector<MapJob> MapSchedule::take(std::span<const uint32_t> first, std::span<const float> brightness,
                                      int resolution, int64_t texels) {
  stale_.resize(brightness.size());
  std::vector<MapJob> jobs;
  for (uint32_t slot : first) {
    jobs.push_back({slot, TexelRect::whole(resolution)});
    stale_[slot] = {};
  }
  // The error of a map grows with the light that its stale texels carry and with the frames it has waited, so the mean
  // error of all is least when texels of light b each wait for frames in proportion to 1/√b: the map with most b ·
  // frames² is next (as in Kadota et al. 2018, "Scheduling policies for minimizing age of information", where it is
  // Whittle's index). Lights below a share of the mean count as that share, so that no map waits for ever.
  constexpr double kLeastShare = 1.0 / 256;
  std::vector<float> perTexel(stale_.size(), 0);
  std::vector<uint32_t> order;
  double sum = 0;
  for (uint32_t i = 0; i < stale_.size(); ++i) {
    if (brightness[i] <= 0) stale_[i] = {}; // an empty slot
    const TexelRect& wanted = stale_[i].texels.empty() ? stale_[i].rough : stale_[i].texels;
    if (wanted.empty()) continue;
    ++stale_[i].frames;
    order.push_back(i);
    perTexel[i] = brightness[i] * fluxPerTexel(wanted, resolution);
    sum += perTexel[i];
  }
  const float least = float(kLeastShare * sum / double(std::max<size_t>(1, order.size())));
  const auto urgency = [&](uint32_t slot) {
    return std::max(perTexel[slot], least) * float(stale_[slot].frames) * float(stale_[slot].frames);
  };
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return urgency(a) > urgency(b); });
  // Stale maps come before rough ones. All coarse first, then as many finely as the rest allows, the most urgent ones.
  std::stable_partition(order.begin(), order.end(), [&](uint32_t slot) { return !stale_[slot].texels.empty(); });
  int64_t rest = texels;
  for (uint32_t slot : order) rest -= texelsTraced(stale_[slot].texels, kRough);
  for (uint32_t slot : order) {
    if (texels <= 0) break;
    Stale& s = stale_[slot];
    TexelRect fine = s.texels;
    fine.add(s.rough);
    const int64_t more = texelsTraced(fine, 1) - texelsTraced(s.texels, kRough);
    const bool coarse = rest < more && !s.texels.empty();
    if (coarse) {
      jobs.push_back({slot, s.texels, kRough});
      texels -= texelsTraced(s.texels, kRough);
      s.texels = {};
      s.rough = fine;
      s.frames = 0;
    } else {
      jobs.push_back({slot, fine});
      texels -= texelsTraced(fine, 1);
      rest -= more;
      s = {};
    }
  }
  std::sort(jobs.begin(), jobs.end(), [](const MapJob& a, const MapJob& b) { return a.slot < b.slot; });
  return jobs;
}

size_t MapSchedule::waiting() const {
  return size_t(std::count_if(stale_.begin(), stale_.end(),
                              [](const Stale& s) { return !s.texels.empty() || !s.rough.empty(); }));
}

} // namespace lambent
