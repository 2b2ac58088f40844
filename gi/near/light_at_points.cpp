#include "gi/near/light_at_points.h"

#include "gi/near/near_light.h"
#include "gi/vpl/smc.h"

namespace lambent {

namespace {
constexpr int kNearRays = 64, kDirectPaths = 256; // of a point
} // namespace

std::vector<vec3> indirectAtPoints(const PointInputs& in, std::span<const SurfaceHit> points) {
  const GatherSettings& gather = in.settings.gather;
  RayCounts counts;
  std::vector<vec3> irradiance = irradianceByRays(in.rays, points, in.virtuals, gather, counts);
  if (gather.near == 0 || !(gather.disk > 0 || gather.clamp > 0)) return irradiance;
  const std::vector<vec3> near = traceNearLightAt(points,
                                                  {.view = in.view,
                                                   .rays = in.rays,
                                                   .lights = in.lights,
                                                   .virtuals = in.virtuals,
                                                   .gather = gather,
                                                   .casts = kNearRays,
                                                   .bounces = in.settings.smc.bounces,
                                                   .seed = in.seed},
                                                  counts);
  for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] += near[i];
  return irradiance;
}

/// As a white patch would reflect it, whose radiance is irradiance/π.
std::vector<vec3> directAtPoints(const PointInputs& in, std::span<const SurfaceHit> points) {
  std::vector<Vpl> patches(points.size());
  std::vector<Vpl*> lit;
  for (size_t i = 0; i < points.size(); ++i) {
    patches[i] = patchOf(points[i], i + 1);
    patches[i].albedo = vec3(1);
    if (points[i].valid()) lit.push_back(&patches[i]);
  }
  RayCounts counts;
  estimateRadiance(lit, in.rays, in.lights, kDirectPaths, 1, in.seed, counts);
  std::vector<vec3> irradiance(points.size());
  for (size_t i = 0; i < points.size(); ++i) irradiance[i] = kPi * patches[i].radiance;
  return irradiance;
}

} // namespace lambent
