// Normal maps, for the G-buffer and for the surfaces that rays from the camera meet.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// Surface normal, world space and unit, that a normal map gives (glTF 2.0, 3.9.3). `normal` and `tangent` are
/// interpolated, world space, of any length; `side` is the bitangent's: side · cross(normal, tangent). `texel` in
/// [0, 1]; `scale` is the material's. Without a direction: the normal, or 0.
SHARED_INLINE vec3 mappedNormal(vec3 normal, vec3 tangent, float side, vec3 texel, float scale) {
  vec3 n = normal * inversesqrt(max(dot(normal, normal), 1e-30f));
  vec3 t = tangent * inversesqrt(max(dot(tangent, tangent), 1e-30f));
  vec3 local = (texel * 2.0f - vec3(1.0f)) * vec3(scale, scale, 1.0f);
  vec3 mapped = t * local.x + cross(n, t) * (side * local.y) + n * local.z;
  float squared = dot(mapped, mapped);
  return dot(tangent, tangent) > 0.0f && squared > 1e-12f ? mapped * inversesqrt(squared) : n;
}

/// A normal that faces away from the viewer is of a slope that hides itself: bent to where it is seen edge on.
SHARED_INLINE vec3 facingViewer(vec3 normal, vec3 towardsViewer) {
  const float kEdgeOn = 0.01f;
  float cosine = dot(normal, towardsViewer);
  return cosine < kEdgeOn ? normalize(normal + towardsViewer * (kEdgeOn - cosine)) : normal;
}

SHARED_END
