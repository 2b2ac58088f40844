// Paraboloid mapping of a hemisphere and the basis it uses, one text for C++ and GLSL so that both makers of shadow
// maps and the gather agree to the texel.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// Right-handed basis around unit n, orthonormal within 4e-7 (Duff et al. 2017, branchless ONB).
SHARED_INLINE void basisAround(vec3 n, SHARED_OUT(vec3) tangent, SHARED_OUT(vec3) bitangent) {
  float s = n.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (s + n.z);
  float b = n.x * n.y * a;
  tangent = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
  bitangent = vec3(b, s + n.y * n.y * a, -n.y);
}

/// Unit direction in the light's frame (z along the normal) to [0,1]² map coordinates; the hemisphere z ≥ 0 fills the
/// inscribed disc. Within 1e-7.
SHARED_INLINE vec2 paraboloidFromDirection(vec3 d) {
  return vec2(d.x, d.y) * (0.5f / (1.0f + d.z)) + vec2(0.5f, 0.5f);
}

/// Inverse of the above, within 4e-7. Coordinates outside the disc give directions with z < 0.
SHARED_INLINE vec3 directionFromParaboloid(vec2 uv) {
  vec2 p = uv * 2.0f - vec2(1.0f, 1.0f);
  float r2 = p.x * p.x + p.y * p.y;
  return vec3(2.0f * p.x, 2.0f * p.y, 1.0f - r2) / (1.0f + r2);
}

SHARED_END
