// A receiver and a light of which a shadow map cannot say whether they see one another: asked of rays.
#ifndef LAMBENT_SHARED_SHADOW_DOUBT_H
#define LAMBENT_SHARED_SHADOW_DOUBT_H
#include "interop.h"
SHARED_BEGIN

struct ShadowDoubt {
  vec3 position; // world
  uint pixel;    // x + 65536 y, from the lower left
  vec3 normal;   // world, unit
  uint light;    // of the frame's direct lights
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::ShadowDoubt) == 32);
#endif
#endif
