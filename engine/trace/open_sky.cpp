#include "engine/trace/open_sky.h"

#include "engine/core/rng.h"
#include "engine/core/sampling.h"

namespace lambent {

namespace {
constexpr uint32_t kPaths = 512;
constexpr int kSegments = 4;
constexpr int kLeast = 50; // one path of so many: less light than this looks like none, and solids leak at their seams
} // namespace

bool skyReaches(const RayQuery& rays, const vec3& eye) {
  uint32_t out = 0;
  for (uint32_t i = 0; i < kPaths; ++i) {
    Rng rng(1, Stream::SkyLight, i);
    Ray ray{eye, sampleSphere(rng.next2())};
    for (int segment = 0; segment < kSegments; ++segment) {
      const SurfaceHit hit = rays.closest(ray);
      if (!hit.valid()) {
        out += ray.direction.y > 0;
        break;
      }
      ray = {offsetPoint(hit.position, hit.geometricNormal, rays.rayEpsilon()),
             sampleCosineHemisphere(hit.geometricNormal, rng.next2())};
    }
  }
  return out * kLeast > kPaths;
}

Glow glowOnSeen(const RayQuery& rays, const CameraView& camera) {
  constexpr uint32_t kPlaces = 2048, kDirections = 4;
  double shown = 0, reaches = 0;
  uint32_t seen = 0;
  for (uint32_t i = 0; i < kPlaces; ++i) {
    const vec3 at = additiveRecurrence3(i, vec3(0));
    const CameraRay through = cameraRay(camera, at.x, at.y);
    const SurfaceHit hit = rays.seen(Ray{through.origin, through.direction});
    if (!hit.valid()) continue;
    ++seen;
    shown += double(luminance(hit.emission));
    Rng rng(2, Stream::SkyLight, i);
    for (uint32_t k = 0; k < kDirections; ++k) {
      const SurfaceHit met = rays.closest(Ray{offsetPoint(hit.position, hit.geometricNormal, rays.rayEpsilon()),
                                              sampleCosineHemisphere(hit.geometricNormal, rng.next2())});
      if (met.valid()) reaches += double(luminance(met.emission));
    }
  }
  if (seen == 0) return {};
  return {float(shown / double(seen)), float(reaches / (double(seen) * kDirections))};
}

float shareLookedThrough(const RayQuery& rays, const CameraView& camera) {
  constexpr int kAcross = 16;
  int met = 0, through = 0;
  for (int i = 0; i < kAcross * kAcross; ++i) {
    const vec2 at = (vec2(i % kAcross, i / kAcross) + 0.5f) / float(kAcross);
    const CameraRay way = cameraRay(camera, at.x, at.y);
    const SurfaceHit hit = rays.closest(Ray{way.origin, way.direction});
    met += hit.valid();
    through += hit.valid() && rays.seen(Ray{way.origin, way.direction}).t != hit.t;
  }
  return met > 0 ? float(through) / float(met) : 0;
}

} // namespace lambent
