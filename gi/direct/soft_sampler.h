// Direct light of what has a size, by few rays from every pixel: emissive surfaces, the sky, suns' disks. Each sample
// takes one light and a place on it, a direction of the sky by what it brings, and a ray by the cosine, or half of the
// time by the lobe of a glossy surface, weighted by multiple importance sampling as in gi/lighting/light_paths.h: the
// expectation is that of the reference.
//
// Numbers are Sobol' points (first two dimensions), scrambled after Owen ("Randomly permuted (t,m,s)-nets", 1995) for
// each pixel. One number of each pair that chooses a light or a direction takes the strata of its block of 4×4 pixels
// in turn: a block has all sixteen in one sample each, and a pixel in sixteen samples.
#pragma once

#include "gi/direct/frame_surfaces.h"
#include "gi/lighting/light_set.h"

namespace lambent {

enum class SoftParts { All, SkyAndSuns };
/// Returns those of the lights that have a size.
LightSet softLightsOf(const LightSet& lights, SoftParts parts);

/// How many samples beyond the others pixels of the frame before ask for, rows from the bottom.
struct MoreSamples {
  std::span<const uint8_t> pixels; // empty: none
  int width = 0, height = 0;
  mat4 clipFromWorld{1}; // of that frame
  /// At the pixel that showed the world-space position; 0 beyond the image.
  int at(const vec3& position) const;
};

struct SoftSampling {
  const RayQuery& rays;
  const LightSet& lights; // softLightsOf
  const SceneView& view;
  const FrameSurfaces* surfaces = nullptr; // of the view's camera; null: what a ray through each pixel's centre meets
  int samples = 1;                         // of each pixel
  MoreSamples more;
  uint32_t sample = 0; // number of the first one: those of a mean follow each other
  bool glossy = false;
  bool normalMaps = false;
  uint32_t seed = 1;
};

/// Light at the image's pixels, row by row from the top.
struct SoftLight {
  std::vector<vec3> irradiance; // W/m²
  std::vector<vec3> glossy;     // as SurfaceLighting::glossy; empty where not asked for
};
SoftLight sampleSoftLight(const SoftSampling& in, RayCounts& counts);

} // namespace lambent
