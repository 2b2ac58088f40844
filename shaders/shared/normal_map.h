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

/// Length of the mean of a pixel's unit normals, as the coarser levels of a normal map hold it: root of 1 less it, so
/// that small slopes keep their digits. `scale` is the material's, and that of slopes; their variance is 1/length − 1
/// (Toksvig 2005, "Mipmapping normal maps").
SHARED_INLINE float meanNormalLength(float stored, float scale) {
  float variance = scale * scale * (1.0f / max(1.0f - stored * stored, 1e-2f) - 1.0f);
  return 1.0f / (1.0f + variance);
}

/// Mean over a pixel's normals of their cosine to a light, 0 where they face away from it. `cosine` is that of their
/// mean direction. Exact for a length of 1; a fit to normal distributions, within 4 % of them up to 85° and within 5 %
/// of bumps of a sine up to 75° (6 to 10 % too dark at 80 to 85°).
SHARED_INLINE float meanCosine(float cosine, float length) {
  float mean = length * cosine;
  // Narrow slopes spread it by the light's sine alone; normals all around, as far as 1/3.
  float variance = (1.0f - length * length) * mix(1.0f / 3.0f, 0.5f - 0.5f * cosine * cosine, length);
  float spread = variance > 0.0f ? 0.6366f * variance * exp(-0.3f * mean * mean / variance) : 0.0f;
  return 0.5f * (mean + sqrt(mean * mean + spread));
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
