// Every visible point against every VPL with a ray each: paper 1's "all VPLs - ray tracing" (fig. 8), the measure that
// separates errors of the VPL set from errors of shadow maps and interleaving. Costs width × height × N rays.
#include "engine/core/parallel.h"
#include "gi/vpl/smc.h"

namespace lambent {

float geometryTerm(float cosReceiver, float cosVpl, float distance2, float area, const GatherSettings& settings) {
  if (cosReceiver <= 0 || cosVpl <= 0) return 0;
  const float g = cosReceiver * cosVpl / glm::max(distance2 + settings.disk * area / kPi, 1e-8f);
  return settings.clamp > 0 ? glm::min(g, settings.clamp) : g;
}

std::vector<vec3> gatherByRays(const RayQuery& rays, const CameraView& camera, std::span<const Vpl> vpls,
                               const GatherSettings& settings, RayCounts& counts) {
  const size_t width = size_t(camera.width), height = size_t(camera.height);
  std::vector<vec3> irradiance(width * height, vec3(0));
  std::vector<RayCounts> perRow(height);
  parallelFor(height, 1, [&](size_t begin, size_t end) {
    std::vector<Ray> primary(width), segments;
    std::vector<SurfaceHit> hits(width);
    std::vector<vec3> values;
    std::vector<uint8_t> blocked;
    for (size_t y = begin; y < end; ++y) {
      for (size_t x = 0; x < width; ++x) {
        const CameraRay r = cameraRay(camera, (float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height));
        primary[x] = {r.origin, r.direction};
      }
      rays.closest(primary, hits);
      perRow[y].closest += width;
      for (size_t x = 0; x < width; ++x) {
        const SurfaceHit& h = hits[x];
        if (!h.valid()) continue;
        const vec3 origin = offsetPoint(h.position, h.geometricNormal);
        segments.clear();
        values.clear();
        for (const Vpl& v : vpls) {
          if (!v.alive || maxComponent(v.radiance) <= 0) continue;
          const vec3 d = v.position - h.position;
          const float r2 = glm::dot(d, d);
          if (!(r2 > 0)) continue;
          const float inverse = 1 / std::sqrt(r2);
          const float g =
              geometryTerm(glm::dot(d, h.normal) * inverse, -glm::dot(d, v.normal) * inverse, r2, v.area, settings);
          if (g <= 0) continue;
          segments.push_back(segment(origin, offsetPoint(v.position, v.geometricNormal)));
          values.push_back(v.radiance * (v.area * g));
        }
        blocked.resize(segments.size());
        rays.occluded(segments, blocked);
        perRow[y].occlusion += segments.size();
        vec3 sum(0);
        for (size_t j = 0; j < values.size(); ++j)
          if (!blocked[j]) sum += values[j];
        irradiance[y * width + x] = sum;
      }
    }
  });
  for (const RayCounts& c : perRow) counts += c;
  return irradiance;
}

} // namespace lambent
