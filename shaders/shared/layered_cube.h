// An entry of the layered depth cube (gi/cube) as pixels look it up: 16 bytes.
#ifndef LAMBENT_SHARED_LAYERED_CUBE_H
#define LAMBENT_SHARED_LAYERED_CUBE_H
#include "interop.h"
SHARED_BEGIN

struct CubeTexel {
  uint normal;     // geometric, octahedral, two snorms of 16 bits
  float distance;  // of its plane from the box's corner along the normal, metres
  uint irradiance; // shared exponent, 9 bits a channel, over the largest of all entries times kCubeRange
  uint place;      // bits 0..7: neighbours (CubeEntry); 8..15 and 16..23: place in its texel, u and v
};

const float kCubeRange = 1.0f / 32768.0f;
const int kCubeBlock = 8; // columns lie in blocks of so many squared

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::CubeTexel) == 16);
#endif
#endif
