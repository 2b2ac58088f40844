// Unit vectors in two numbers (octahedral map), one text for C++ and GLSL.
#pragma once
#include "interop.h"
SHARED_BEGIN

SHARED_INLINE vec2 octahedralFold(vec2 p) {
  return vec2((p.x >= 0.0f ? 1.0f : -1.0f) * (1.0f - abs(p).y), (p.y >= 0.0f ? 1.0f : -1.0f) * (1.0f - abs(p).x));
}

/// Unit n to [-1,1]².
SHARED_INLINE vec2 octahedralFromUnit(vec3 n) {
  vec3 a = abs(n);
  vec2 p = vec2(n.x, n.y) / (a.x + a.y + a.z);
  return n.z < 0.0f ? octahedralFold(p) : p;
}

/// Inverse of the above: within 2e-5 of n, through two snorms of 16 bits within 7e-5. A z within rounding of zero becomes zero: basisAround() switches on its sign, and both sides
/// must switch alike. (Snorm16 steps are 3e-5, so no other value comes that close.)
SHARED_INLINE vec3 unitFromOctahedral(vec2 p) {
  vec2 a = abs(p);
  float z = 1.0f - a.x - a.y;
  if (z > -1e-5f && z < 1e-5f)
    z = 0.0f;
  vec2 xy = z < 0.0f ? octahedralFold(p) : p;
  return normalize(vec3(xy.x, xy.y, z));
}

SHARED_END
