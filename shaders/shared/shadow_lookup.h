// How a paraboloid map answers for a receiver, one text for the gather and for the measure of its errors.
#ifndef LAMBENT_SHARED_SHADOW_LOOKUP_H
#define LAMBENT_SHARED_SHADOW_LOOKUP_H
#include "paraboloid.h"
SHARED_BEGIN

/// Share of the far distance that map values may be off by: rounding to 16 bits and the offset of the map's origin.
SHARED_INLINE float paraboloidRounding() { return 4e-5f; }

/// Distance that the map must hold at least for the receiver to be lit, times the cosine at the receiver (kept as a factor
/// to spare a division per light). The bias is what the receiver's plane can rise within `biasTexels` map texels,
/// distance · texelAngle · tanθ, and a tenth of a texel for round-off. `cosineLight` is that of the direction to the
/// receiver at the light; the stereographic scale of the map grows with it.
SHARED_INLINE float paraboloidReach(float distanceMetres, float cosineReceiver, float cosineLight, float biasTexels,
                                    float resolution) {
  float texelAngle = biasTexels * 2.0f / resolution * (1.0f + cosineLight);
  float sine = sqrt(max(0.0f, 1.0f - cosineReceiver * cosineReceiver));
  return distanceMetres * (cosineReceiver - texelAngle * (sine + 0.1f * cosineReceiver));
}

SHARED_END
#endif
