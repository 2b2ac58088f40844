// Surfaces as glossy receivers (shaders/shared/ggx.h) for the gathers on the CPU and the reference.
#pragma once

#include "engine/trace/ray_query.h"
#include "shaders/shared/ggx.h"

#include <span>
#include <vector>

namespace lambent {

/// Gives a valid hit the normal that its normal map has for `view`'s camera.
void applyNormalMap(const SceneView& view, SurfaceHit& hit);

/// The surface that `view`'s camera sees at a valid hit, as the G-buffer holds it; the second with a finish of its own.
Receiver receiverOf(const SceneView& view, const SurfaceHit& hit);
Receiver receiverOf(const SceneView& view, const SurfaceHit& hit, const vec4& finish);

/// Radiance towards the viewer per irradiance from `direction` (unit), both parts of the reflection, 1/sr. Zero below
/// the surface.
vec3 reflectanceOf(const Receiver& receiver, const vec3& direction);

/// Unit direction to look for light that the receiver reflects: with equal chances cosine-distributed, or the viewer's
/// mirrored at a normal drawn from the lobe (Walter et al. 2007, eq. 35), which may lie below the surface. `uChoice`
/// and `u` in [0, 1).
vec3 sampleReflection(const Receiver& receiver, float uChoice, vec2 u);
/// Density of sampleReflection, per steradian.
float pdfReflection(const Receiver& receiver, const vec3& direction);

/// Unit direction that the lobe alone mirrors the viewer into, at a normal drawn from those that the viewer sees (Heitz
/// 2018; as spherical caps, Dupuy and Benyoub 2023). It may lie below the surface. `u` in [0, 1).
vec3 sampleLobe(const Receiver& receiver, vec2 u);
/// Density of sampleLobe, per steradian.
float pdfLobe(const Receiver& receiver, const vec3& direction);

} // namespace lambent
