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

/// A metal's normal that mirrors the viewer into the surface, where nothing is to be seen: turned towards the surface's
/// until it mirrors them along the surface, or as far above it as they are (Keller et al. 2017, "The Iray Light
/// Transport Simulation and Rendering System", on shading normals). All unit, world space; `geometric` on the viewer's
/// side. Other surfaces have a Lambert part, which would show the turn, and keep theirs.
SHARED_INLINE vec3 mirroringOutwards(vec3 normal, vec3 geometric, vec3 towardsViewer, float metalness) {
  const float kAlong = 0.1f;
  vec3 across = normal - geometric * dot(normal, geometric);
  float slope = length(across), up = dot(towardsViewer, geometric), height = min(kAlong, up);
  float mirrored = 2.0f * dot(normal, towardsViewer) * dot(normal, geometric) - up;
  if (!(metalness > 0.0f && mirrored < height && slope > 0.0f)) return normal;
  // In the plane of both normals: halfway between the viewer and that height.
  across *= 1.0f / slope;
  float along = dot(towardsViewer, across), r = max(length(vec2(along, up)), 1e-6f), c = min(height / r, 1.0f);
  vec3 turned = across * (along / r + sqrt(1.0f - c * c)) + geometric * (up / r + c);
  return normalize(mix(normal, normalize(turned), metalness));
}

SHARED_END
