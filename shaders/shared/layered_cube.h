// An entry of the layered depth cube (gi/cube) as pixels look it up: 16 bytes.
#pragma once
#include "interop.h"
SHARED_BEGIN

struct CubeTexel {
  uint normal;     // geometric, octahedral, two snorms of 16 bits
  float distance;  // of its plane from the box's corner along the normal, metres
  uint irradiance; // shared exponent, 9 bits a channel, over the largest of all entries times kCubeRange
  uint place;      // bits 0..7: neighbours (CubeEntry); 8..15 and 16..23: place in its texel, u and v
};

/// Of a tree of cubes: a cube, or where there are children, the one that these replace.
struct CubeNode {
  vec3 corner;      // world
  float texel;      // metres
  uint children;    // number of the first of eight, x fastest; 0: none
  uint firstColumn; // of the cube
  uint unused0, unused1;
};

const float kCubeRange = 1.0f / 32768.0f;
const int kCubeBlock = 8; // columns lie in blocks of so many squared

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::CubeTexel) == 16);
static_assert(sizeof(lambent::CubeNode) == 32);
#endif
