// The scene as arrays that a shader traces rays through (lib/rays.glsl): elements of storage buffers, std430.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// Box of a hierarchy in depth-first order: whoever meets it goes on with the next node, or with what the leaf holds;
/// whoever misses it goes on with node `skip`, which lies behind all that is below.
struct BvhNode {
  vec3 lo;
  uint skip;
  vec3 hi;
  uint leaf; // 0: not one; else first · 8 + count of what it holds
};

/// In object space, in the order of the leaves.
struct RayTriangle {
  vec3 p0;
  uint triangle; // of its mesh
  vec3 p1;
  uint mask; // into the masked triangles, or 2³² − 1: solid
  vec3 p2;
  uint pad;
};

/// In the order of the upper hierarchy's leaves.
struct RayInstance {
  vec4 objectFromWorld[3]; // rows
  uint firstNode, nodes;   // of its mesh's hierarchy; its skips count from firstNode on
  uint firstTriangle;      // that its leaves count from
  uint instance;           // into SceneView::instances
};

/// A triangle whose material is cut out where alpha lies below the cutoff, or blended (coverage.h). Its image's alpha is
/// a byte per texel, four to a word, in rows from v = 0 on.
struct RayMask {
  vec4 corners[3]; // xy: coordinates in the image, [0,1] being all of it; z: alpha that the texel's is multiplied by;
                   // w of the first: the cutoff, or −1 where it is blended; of the second then: the triangle's
                   // number in its primitive
  uint firstTexel;
  int width, height; // 0: no image, its alpha is 1
  uint modes;        // wrapU | wrapV · 4 | nearest · 16; of wraps: 0 repeat, 1 mirrored, 2 clamped
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::BvhNode) == 32 && sizeof(lambent::RayTriangle) == 48 &&
              sizeof(lambent::RayInstance) == 64 && sizeof(lambent::RayMask) == 64);
#endif
