#include "gi/visibility/shadow_agreement.h"

#include "engine/core/parallel.h"
#include "gi/visibility/paraboloid_maps.h"
#include "gi/vpl/smc.h"
#include "shaders/shared/shadow_lookup.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// Receivers on a grid of camera rays, with the normals that the G-buffer has.
std::vector<SurfaceHit> visibleSurfaces(const RayQuery& rays, const CameraView& camera, int count) {
  const int columns = std::max(1, int(std::sqrt(float(count) * camera.aspect()))), rows = std::max(1, count / columns);
  std::vector<SurfaceHit> out;
  for (int i = 0; i < columns * rows; ++i) {
    const CameraRay r = cameraRay(camera, (float(i % columns) + 0.5f) / columns, (float(i / columns) + 0.5f) / rows);
    const SurfaceHit h = rays.seen(Ray{r.origin, r.direction});
    if (h.valid()) out.push_back(h);
  }
  return out;
}

/// What the gather decides with this map (metres) for a receiver in direction d, a unit vector in the map's frame as
/// its normal is.
bool lit(const std::vector<float>& map, const ParaboloidMapInputs& maps, const vec3& d, const vec3& normal,
         float distance, float cosReceiver, float bias) {
  const vec2 uv = paraboloidFromDirection(d);
  const int x = std::clamp(int(uv.x * float(maps.resolution)), 0, maps.resolution - 1);
  const int y = std::clamp(int(uv.y * float(maps.resolution)), 0, maps.resolution - 1);
  const float share = std::min(map[size_t(y) * maps.resolution + x] / maps.farDistance, 1.0f);
  const vec2 centre = (vec2(x, y) + 0.5f) * (2.0f / float(maps.resolution)) - 1.0f;
  return paraboloidLit(paraboloidShare(paraboloidValue(share)) * maps.farDistance, centre, normal, distance,
                       cosReceiver, bias, float(maps.resolution));
}

} // namespace

ShadowAgreement measureShadowAgreement(ParaboloidMapPass& pass, const ParaboloidMapInputs& maps, const RayQuery& rays,
                                       const CameraView& camera, std::span<const VirtualLight> lights,
                                       const Settings& settings, int slots, int points,
                                       const std::function<void(int, int)>& progress) {
  const std::vector<SurfaceHit> receivers = visibleSurfaces(rays, camera, points);
  std::vector<uint32_t> alive;
  for (uint32_t i = 0; i < lights.size(); ++i)
    if (lights[i].alive) alive.push_back(i);
  ShadowAgreement result;
  double total = 0, makers = 0, raster = 0, cast = 0;
  const int count = std::min<int>(slots, int(alive.size()));
  for (int k = 0; k < count; ++k) {
    if (progress) progress(k, count);
    const uint32_t slot = alive[size_t(k) * alive.size() / count];
    const VirtualLight& v = lights[slot];
    const MakerComparison comparison = pass.compareMakers(maps, maps.poses[slot]);
    vec3 tangent, bitangent;
    basisAround(v.normal, tangent, bitangent);
    for (const SurfaceHit& h : receivers) {
      const vec3 d = h.position - v.position;
      const float r2 = glm::dot(d, d), r = std::sqrt(r2);
      if (!(r > 0)) continue;
      const float cosReceiver = -glm::dot(d, h.normal) / r, cosVpl = glm::dot(d, v.normal) / r;
      const double weight =
          double(luminance(v.radiance)) * v.area * geometryTerm(cosReceiver, cosVpl, r2, v.area, settings.gather);
      if (!(weight > 0)) continue;
      const mat3 mapFromWorld = glm::transpose(mat3(tangent, bitangent, v.normal));
      const vec3 direction = mapFromWorld * d / r, normal = mapFromWorld * h.normal;
      const bool byRaster = lit(comparison.raster, maps, direction, normal, r, cosReceiver, settings.shadow.bias);
      const bool byCast = lit(comparison.rays, maps, direction, normal, r, cosReceiver, settings.shadow.bias);
      const bool byRay = !rays.occluded(segment(offsetPoint(h.position, h.geometricNormal, rays.rayEpsilon()),
                                                offsetPoint(v.position, v.geometricNormal, rays.rayEpsilon())));
      ++result.pairs;
      total += weight;
      makers += byRaster != byCast ? weight : 0;
      raster += byRaster != byRay ? weight : 0;
      cast += byCast != byRay ? weight : 0;
    }
  }
  if (progress) progress(count, count);
  if (total > 0) {
    result.makers = makers / total;
    result.rasterAgainstRays = raster / total;
    result.castAgainstRays = cast / total;
  }
  return result;
}

} // namespace lambent
