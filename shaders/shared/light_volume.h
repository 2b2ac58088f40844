// A grid that light propagates through: what its filling, its steps and its readers must agree on. Lengths are in cells.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// Spherical harmonics of two bands, about which light leaves a cell: intensity I(ω) = kBand0 c.x + kBand1 dot(c.yzw, ω).
const float kBand0 = 0.28209479f; // 1/(2√π)
const float kBand1 = 0.48860251f; // √3/(2√π)
/// Coefficients of the clamped cosine about a direction that carries a flux of 1.
const float kLobe0 = 0.28209479f; // (√π/2)/π
const float kLobe1 = 0.32573501f; // √(π/3)/π
const float kFluxOfBand0 = 3.54490770f; // √(4π): flux of a coefficient c.x of 1

/// What lies on surfaces is looked for so far off them.
const float kVolumeShift = 0.25f;

/// How much of the light at x on a surface (already shifted off it) is that of the cell whose centre is given: trilinear,
/// and nothing of a cell that lies behind the surface.
SHARED_INLINE float volumeWeight(vec3 x, vec3 centre, vec3 normal) {
  vec3 way = centre - x;
  float trilinear = max(0.0f, 1.0f - abs(way.x)) * max(0.0f, 1.0f - abs(way.y)) * max(0.0f, 1.0f - abs(way.z));
  float height = dot(way, normal) + kVolumeShift;
  return trilinear * clamp(height * 4.0f, 0.0f, 1.0f);
}

/// Which of the 64 parts of the two cells' width around a centre a place lies in: the bit of the centre's sights.
SHARED_INLINE int volumePart(vec3 x, vec3 centre) {
  vec3 at = clamp(floor((x - centre) * 2.0f + 2.0f), vec3(0.0f), vec3(3.0f));
  return int(at.x) + 4 * int(at.y) + 16 * int(at.z);
}

SHARED_END
