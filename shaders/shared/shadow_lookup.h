// How a paraboloid map answers for a receiver, one text for the gather and for the measure of its errors.
#ifndef LAMBENT_SHARED_SHADOW_LOOKUP_H
#define LAMBENT_SHARED_SHADOW_LOOKUP_H
#include "paraboloid.h"
SHARED_BEGIN

/// Map coordinates in xy and, in z, the distance in metres that the map must hold at least for the receiver to be lit.
/// The bias is what the receiver's plane can rise within `biasTexels` map texels, plus the map's own rounding (16 bits)
/// and its origin's offset from the surface. `towardsReceiver` is unit; `cosineReceiver` > 0.
SHARED_INLINE vec3 paraboloidLookup(vec3 normalLight, vec3 towardsReceiver, float distanceMetres, float cosineReceiver,
                                    float resolution, float biasTexels, float farDistance) {
  vec3 tangent, bitangent;
  basisAround(normalLight, tangent, bitangent);
  vec3 d = vec3(dot(tangent, towardsReceiver), dot(bitangent, towardsReceiver), dot(normalLight, towardsReceiver));
  float texelAngle = 2.0f / resolution * (1.0f + d.z); // stereographic scale of the map, radians
  float sine = sqrt(max(0.0f, 1.0f - cosineReceiver * cosineReceiver));
  float tangentReceiver = min(sine / cosineReceiver, 16.0f);
  float bias = distanceMetres * texelAngle * biasTexels * (tangentReceiver + 0.1f) + farDistance * 4e-5f;
  vec2 uv = paraboloidFromDirection(d);
  return vec3(uv.x, uv.y, distanceMetres - bias);
}

SHARED_END
#endif
