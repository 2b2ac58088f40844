// A VPL as the gather reads it: four vec4 of a uniform block (64 KiB = 1024 lights). The light's frame is stored, not
// derived: unpacking a normal and building its basis at every pixel costs software Mesa half of the loop again.
#pragma once
#include "interop.h"
SHARED_BEGIN

struct VplLight {
  vec4 positionArea;   // xyz: world position; w: area a, m² (0: empty slot)
  vec4 powerNormalX;   // rgb: L·a, outgoing radiance times patch area, W/sr; w: the normal's x
  vec4 tangentNormalY; // xyz: tangent of basisAround(normal); w: the normal's y
  vec4 bitangentNormalZ;
};

const int kLightClasses = 16;    // interleaving: slot mod 16
const int kLightsPerClass = 128; // of a chunk of 2048 slots
const int kClassesPerLightBlock = 8;

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::VplLight) == 64);
#endif
