// How a paraboloid map answers for a receiver, one text for the gather and for the measure of its errors.
#pragma once
#include "paraboloid.h"
SHARED_BEGIN

/// What a map holds of a distance, both as shares of the far distance: its root, so that 16 bits tell near ones apart
/// where far surfaces are seen too.
SHARED_INLINE float paraboloidValue(float share) { return sqrt(share); }
/// Shares of the far distance that values may stand for, at most: rounded, and the map's origin off its surface.
SHARED_INLINE float paraboloidShare(float value) {
  float above = value + 1.0f / 65535.0f;
  return above * above + 1e-5f;
}
/// The other way round: the least value for which that is `share` or more.
SHARED_INLINE float leastParaboloidValue(float share) { return sqrt(max(share - 1e-5f, 0.0f)) - 1.0f / 65535.0f; }

/// Whether a texel leaves a receiver in the light. `met` is the distance that it holds, `centre` its place in [-1,1]²,
/// `normal` the receiver's in the light's frame, `distance` the receiver's, `cosine` that at the receiver; metres.
///
/// The texel was drawn through its centre, the receiver lies next to that: what counts is where the receiver's plane is
/// in the direction of the centre, distance · cosine / cosineCentre. No nearer than the receiver where the plane falls
/// away: near edges it is not there. `biasTexels` texels' share of the distance are left for round-off and for surfaces
/// that are not planes. (An allowance for the plane in any direction, distance · tanθ · texel, lets light in under all
/// that stands on floors: relMSE 0.31 in place of 0.14 in veach-ajar, all VPLs at every pixel; by rays 0.10.)
SHARED_INLINE bool paraboloidLit(float met, vec2 centre, vec3 normal, float distanceMetres, float cosine,
                                 float biasTexels, float resolution) {
  float r2 = centre.x * centre.x + centre.y * centre.y;
  float cosineCentre = -(2.0f * (normal.x * centre.x + normal.y * centre.y) + normal.z * (1.0f - r2)) / (1.0f + r2);
  return met * max(cosineCentre, cosine) >= distanceMetres * cosine * (1.0f - biasTexels * 2.0f / resolution);
}

SHARED_END
