// Paper 1, 3.2.2: which VPLs can still bring light to the image. Two things differ from the paper: points shoot in
// blocks and a block skips what earlier blocks verified, so a handful of unverified VPLs does not draw V rays from
// every point; and only pairs that face each other count, since others exchange no light.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// Whether the camera's image holds the point (it may still be hidden).
bool inFrustum(const CameraView& camera, const mat4& viewFromWorld, const vec3& p) {
  const vec3 v = vec3(viewFromWorld * vec4(p, 1));
  if (camera.orthoHalfHeight > 0)
    return v.z < 0 && std::abs(v.y) <= camera.orthoHalfHeight &&
           std::abs(v.x) <= camera.orthoHalfHeight * camera.aspect();
  const float half = -v.z * std::tan(0.5f * camera.fovY);
  return -v.z > camera.near && std::abs(v.y) <= half && std::abs(v.x) <= half * camera.aspect();
}

/// From one point off a surface to another, all the way: `segment` stops a ten-thousandth short, so over some metres it
/// would miss the surface that the other point lies behind, and see the back of a thin wall from the front.
Ray allTheWay(const vec3& a, const vec3& b) { return {a, b - a, 1}; }

/// From the camera to a point off a surface.
Ray cameraSegment(const CameraView& camera, const mat4& viewFromWorld, const vec3& p) {
  if (camera.orthoHalfHeight <= 0) return allTheWay(camera.position(), p);
  const vec3 v = vec3(viewFromWorld * vec4(p, 1));
  return allTheWay(vec3(camera.worldFromView * vec4(v.x, v.y, 0, 1)), p);
}

vec3 offPosition(const Vpl& v, const RayQuery& rays) {
  return offsetPoint(v.position, v.geometricNormal, rays.rayEpsilon());
}

} // namespace

void verifyMailboxes(std::span<Vpl> vpls, const RayQuery& rays, const CameraView& camera,
                     const VisibilityUpdate& update, RayCounts& counts) {
  const mat4 viewFromWorld = glm::inverse(camera.worldFromView);
  constexpr size_t kGrain = 64;
  parallelCount(vpls.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<Ray> block;
    std::vector<uint32_t> owner;
    for (size_t i = begin; i < end; ++i) {
      Vpl& v = vpls[i];
      if (!v.valid) continue;
      const bool carried = !update.carried.empty() && update.carried[i];
      v.valid = inFrustum(camera, viewFromWorld, v.mailbox) && !update.moved->touches(v.mailbox, 0);
      // It may have turned its back; where the carrier is a speck or a thread, rays miss it.
      if (carried) v.valid = v.valid && glm::dot(v.mailbox - v.position, v.geometricNormal) > 0;
      if (!v.valid) continue;
      const Ray towards[2] = {cameraSegment(camera, viewFromWorld, v.mailbox),
                              allTheWay(v.mailbox, offPosition(v, rays))};
      const bool doubtful[2] = {update.camera, carried};
      for (int k = 0; k < 2; ++k) {
        if (!doubtful[k] && !update.moved->touches(towards[k])) continue;
        block.push_back(towards[k]);
        owner.push_back(uint32_t(i));
      }
    }
    std::vector<uint8_t> blocked(block.size());
    rays.occluded(block, blocked);
    count.occlusion += block.size();
    for (size_t j = 0; j < block.size(); ++j)
      if (blocked[j]) vpls[owner[j]].valid = false;
  });
}

void verifyByPoints(VplSet& set, const RayQuery& rays, std::span<const VisiblePoint> points, int raysPerPoint,
                    uint32_t seed, RayCounts& counts) {
  constexpr size_t kPointsPerBlock = 256;
  std::vector<uint32_t> open;
  for (uint32_t round = 0; round < 2; ++round) {
    for (size_t first = 0; first < points.size(); first += kPointsPerBlock) {
      open.clear();
      for (uint32_t i = 0; i < set.slots.size(); ++i)
        if (set.slots[i].alive && !set.slots[i].valid) open.push_back(i);
      if (open.empty()) return;
      // Fewer open VPLs than V: each point tries each of them once at most.
      const size_t tries = std::min<size_t>(raysPerPoint, open.size());
      const size_t count = std::min(kPointsPerBlock, points.size() - first);
      std::vector<uint32_t> found(count * tries, kNone); // slot that this ray verified
      parallelCount(count, 16, counts, [&](size_t begin, size_t end, RayCounts& shot) {
        std::vector<Ray> block;
        std::vector<size_t> place;
        for (size_t p = begin; p < end; ++p) {
          const VisiblePoint& x = points[first + p];
          Rng rng(seed, Stream::Validation, uint32_t(first + p) * 2 + round, set.frame);
          for (size_t k = 0; k < tries; ++k) {
            const uint32_t slot = open[tries < open.size() ? rng.below(uint32_t(open.size())) : k];
            const Vpl& v = set.slots[slot];
            const vec3 d = offPosition(v, rays) - x.position;
            if (glm::dot(d, x.normal) <= 0 || glm::dot(d, v.geometricNormal) >= 0) continue;
            block.push_back(allTheWay(x.position, offPosition(v, rays)));
            place.push_back(p * tries + k);
            found[place.back()] = slot;
          }
        }
        std::vector<uint8_t> blocked(block.size());
        rays.occluded(block, blocked);
        shot.occlusion = block.size();
        for (size_t j = 0; j < block.size(); ++j)
          if (blocked[j]) found[place[j]] = kNone;
      });
      for (size_t j = 0; j < found.size(); ++j)
        if (found[j] != kNone && !set.slots[found[j]].valid) {
          set.slots[found[j]].valid = true;
          set.slots[found[j]].mailbox = points[first + j / tries].position;
        }
    }
  }
}

} // namespace lambent
