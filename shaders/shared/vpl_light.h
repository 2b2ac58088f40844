// A VPL as the gather reads it: 32 bytes, two vec4 of a uniform block (64 KiB = 2048 lights).
#ifndef LAMBENT_SHARED_VPL_LIGHT_H
#define LAMBENT_SHARED_VPL_LIGHT_H
#include "interop.h"
SHARED_BEGIN

struct VplLight {
  vec4 positionNormal; // xyz: world position; w: bits of the normal, packSnorm2x16 of its octahedral coordinates
  vec4 powerArea;      // rgb: L·a, outgoing radiance times patch area, W/sr; w: area a, m² (0: empty slot)
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::VplLight) == 32);
#endif
#endif
