// Virtual lights with exact areas, spread evenly over the inside of a box, and radiance for lights that are given.
#pragma once

#include "gi/vpl/smc.h"
#include "tests/support/test.h"

namespace lambent::test {

/// `count` lights, uniform over the faces of the box [0, size], without radiance yet. Sets are independent.
inline std::vector<Vpl> spreadOverBox(const vec3& size, const vec3& albedo, uint32_t count, uint32_t set) {
  const vec3 areas(size.y * size.z, size.x * size.z, size.x * size.y); // of a face, by axis
  const float total = 2 * (areas.x + areas.y + areas.z);
  std::vector<Vpl> vpls(count);
  for (uint32_t i = 0; i < count; ++i) {
    Rng rng(set, Stream::Test, i);
    float u = rng.next() * total;
    int face = 0;
    for (; face < 5 && u >= areas[face / 2]; ++face) u -= areas[face / 2];
    Vpl& v = vpls[i];
    v.position = size * rng.next3();
    v.position[face / 2] = face % 2 ? size[face / 2] : 0;
    v.normal = vec3(0);
    v.normal[face / 2] = face % 2 ? -1.0f : 1.0f;
    v.geometricNormal = v.normal;
    v.albedo = albedo;
    v.area = total / float(count);
    v.id = uint64_t(set) * count + i;
    v.alive = true;
  }
  return vpls;
}

/// Estimates radiance from scratch, over the lights' cells where these are given.
inline void relight(std::vector<Vpl>& vpls, const RayQuery& rays, const LightSet& lights, int paths, int bounces,
                    uint32_t seed = 1, std::span<const VplCell> cells = {}) {
  std::vector<Vpl*> all;
  for (Vpl& v : vpls) all.push_back(&v);
  std::vector<const VplCell*> standingFor;
  for (const VplCell& c : cells) standingFor.push_back(&c);
  RayCounts counts;
  estimateRadiance(all, rays, lights, paths, bounces, seed, counts, RadianceUse::Rendering, standingFor);
}

} // namespace lambent::test
