// Direct light of what has a size, by few rays from every pixel: emissive surfaces, the sky, suns' disks. Each sample
// takes one light and a place on it, a direction of the sky by what it brings, and a ray by the cosine, or half of the
// time by the lobe of a glossy surface, weighed by multiple importance sampling as in gi/lighting/light_paths.h: the
// expectation is that of the reference.
//
// The pixels of 4×4 take the strata of one pattern in turn, and each pixel goes through all of them from sample to
// sample: Sobol' points (first two dimensions), scrambled after Owen ("Randomly permuted (t,m,s)-nets", 1995) per block
// down to the strata and per pixel below them.
#pragma once

#include "gi/direct/frame_surfaces.h"
#include "gi/lighting/light_set.h"

namespace lambent {

/// Says whether a punctual light has a size, and so no sharp shadows.
inline bool isSoft(const LightView& light) { return light.type == LightType::Directional && light.angularRadius > 0; }

enum class SoftParts { All, SkyAndSuns };
/// Returns those of the lights that have a size.
LightSet softLightsOf(const LightSet& lights, SoftParts parts);

struct SoftSampling {
  const RayQuery& rays;
  const LightSet& lights; // softLightsOf
  const SceneView& view;
  const FrameSurfaces& surfaces; // of the view's camera
  int samples = 1;               // of each pixel
  uint32_t sample = 0;           // number of the first one: those of a mean follow each other
  bool glossy = false;
  uint32_t seed = 1;
};

/// Light at the image's pixels, row by row from the top.
struct SoftLight {
  std::vector<vec3> irradiance; // W/m²
  std::vector<vec3> glossy;     // as SurfaceLighting::glossy; empty where not asked for
};
SoftLight sampleSoftLight(const SoftSampling& in, RayCounts& counts);

} // namespace lambent
