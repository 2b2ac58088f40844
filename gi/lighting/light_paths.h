// What a light path does at a vertex, shared by the VPLs' radiosity, soft direct light and the reference: one
// connection to a chosen light, one to the sky where it is not constant, and the share of an emitter or of the sky that
// a ray of the vertex met. Such rays are cosine-distributed, or drawn by what a glossy receiver reflects
// (sampleReflection). Connections and rays split their light by multiple importance sampling (power heuristic, Veach
// 1997).
#pragma once

#include "gi/lighting/light_set.h"
#include "gi/lighting/receivers.h"

namespace lambent {

/// A place on a surface where light is collected.
struct PathVertex {
  vec3 position, normal, geometricNormal; // unit normals, on the side that is lit
  const Receiver* receiver = nullptr;     // whose rays are drawn by sampleReflection; null: cosine-distributed
};
/// Density of the vertex's own rays, per steradian.
float pdfOfRay(const PathVertex& vertex, const vec3& direction);

/// Light that reaches a vertex if the segment is clear. `value` is zero where there is nothing to test.
struct LightConnection {
  Ray segment;
  vec3 value{0};
};

/// Chooses one light and a point on it. `weight` turns irradiance/π at the vertex into what the caller wants; numbers
/// in [0, 1) for the choice and for the point; `rayEpsilon` is the ray query's.
LightConnection connectToLight(const LightSet& lights, const PathVertex& vertex, const vec3& weight, float uLight,
                               const vec3& uPoint, float rayEpsilon);

/// Light of a sky that is not constant, from a direction drawn by what the sky brings to the vertex; numbers in [0, 1).
LightConnection connectToSky(const LightSet& lights, const PathVertex& vertex, const vec3& weight, vec2 u,
                             float rayEpsilon);

/// Radiance that a ray from `vertex` brings when it meets the sky: all where the sky is constant, else its share;
/// connections bring the rest. A glossy receiver's rays bring their share of suns' disks too.
vec3 skyByRay(const LightSet& lights, const PathVertex& vertex, const vec3& direction);

/// Share of the emission at `hit` that belongs to a ray from `vertex`; connections bring the rest.
float emitterShare(const LightSet& lights, const PathVertex& vertex, const vec3& direction, const SurfaceHit& hit);

} // namespace lambent
