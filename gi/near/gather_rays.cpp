// Every visible point against every VPL with a ray each: paper 1's "all VPLs - ray tracing" (fig. 8), the measure that
// separates errors of the VPL set from errors of shadow maps and interleaving. Costs width × height × N rays.
#include "engine/core/parallel.h"
#include "gi/lighting/receivers.h"
#include "gi/vpl/smc.h"
#include "shaders/shared/coverage.h"

namespace lambent {

float geometryTerm(float cosReceiver, float cosVpl, float distance2, float area, const GatherSettings& settings) {
  if (cosReceiver <= 0 || cosVpl <= 0) return 0;
  const float g = cosReceiver * cosVpl / glm::max(distance2 + settings.disk * area / kPi, 1e-20f);
  return settings.clamp > 0 ? glm::min(g, settings.clamp) : g;
}

std::vector<SurfaceHit> surfacesAt(const RayQuery& rays, const CameraView& camera, std::span<const vec2> points,
                                   const SceneView* normalMaps, std::span<const uint32_t> keys) {
  std::vector<Ray> block;
  const vec3 forward = -vec3(camera.worldFromView[2]);
  for (const vec2& p : points) {
    const CameraRay r = cameraRay(camera, p.x, p.y);
    const ivec2 pixel(vec2(p.x, 1 - p.y) * vec2(camera.width, camera.height)); // from the bottom
    const uint32_t own = camera.throughBlended ? kMeetsNone : pixelKey(uint32_t(pixel.x), uint32_t(pixel.y));
    block.push_back({r.origin + r.direction * (camera.near / glm::dot(r.direction, forward)), r.direction, kInfinity,
                     keys.empty() ? own : keys[block.size()]});
  }
  std::vector<SurfaceHit> hits(block.size());
  rays.seen(block, hits);
  for (SurfaceHit& h : hits)
    if (normalMaps && h.valid()) applyNormalMap(*normalMaps, h);
  return hits;
}

std::vector<vec3> irradianceByRays(const RayQuery& rays, std::span<const SurfaceHit> surfaces,
                                   std::span<const VirtualLight> lights, const GatherSettings& settings,
                                   RayCounts& counts, GlossyGather* glossy) {
  constexpr size_t kGrain = 16;
  if (glossy) glossy->radiance.assign(surfaces.size(), vec3(0));
  std::vector<vec3> irradiance(surfaces.size(), vec3(0));
  parallelCount(surfaces.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<Ray> segments;
    std::vector<vec3> values;
    std::vector<float> spreads; // of lobes
    std::vector<uint8_t> blocked;
    for (size_t i = begin; i < end; ++i) {
      const SurfaceHit& h = surfaces[i];
      if (!h.valid()) continue;
      const vec3 origin = offsetPoint(h.position, h.geometricNormal, rays.rayEpsilon());
      segments.clear();
      values.clear();
      spreads.clear();
      for (const VirtualLight& v : lights) {
        if (!v.alive || maxComponent(v.radiance) <= 0) continue;
        const vec3 d = v.position - h.position;
        const float r2 = glm::dot(d, d);
        if (!(r2 > 0)) continue;
        const float inverse = 1 / std::sqrt(r2);
        const float g =
            geometryTerm(glm::dot(d, h.normal) * inverse, -glm::dot(d, v.normal) * inverse, r2, v.area, settings);
        if (g <= 0) continue;
        segments.push_back(segment(origin, offsetPoint(v.position, v.geometricNormal, rays.rayEpsilon())));
        values.push_back(v.radiance * (v.area * g));
        if (glossy) spreads.push_back(lobeSpread(settings.spread, v.area, -glm::dot(d, v.normal) * inverse, r2));
      }
      blocked.resize(segments.size());
      rays.occluded(segments, blocked);
      count.occlusion += segments.size();
      for (size_t j = 0; j < values.size(); ++j)
        if (!blocked[j]) irradiance[i] += values[j];
      if (!glossy) continue;
      const Receiver seen = receiverOf(glossy->view, h), receiver = forVirtualLights(seen, settings.mirrors > 0);
      for (size_t j = 0; j < values.size(); ++j)
        if (!blocked[j])
          glossy->radiance[i] +=
              values[j] * glossyReflectance(receiver, glm::normalize(segments[j].direction), spreads[j]);
      glossy->radiance[i] /= glossyTint(seen);
    }
  });
  return irradiance;
}

std::vector<vec3> gatherByRays(const RayQuery& rays, const CameraView& camera, std::span<const VirtualLight> lights,
                               const GatherSettings& settings, RayCounts& counts, GlossyGather* glossy,
                               const SceneView* normalMaps) {
  std::vector<vec2> centres;
  for (size_t i = 0; i < size_t(camera.width) * size_t(camera.height); ++i) centres.push_back(pixelCentre(camera, i));
  counts.closest += centres.size();
  return irradianceByRays(rays, surfacesAt(rays, camera, centres, normalMaps), lights, settings, counts, glossy);
}

} // namespace lambent
