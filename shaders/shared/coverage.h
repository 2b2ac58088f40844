// Alpha blending as chance: a surface of alpha a is there for a share a of pixels and rays, and not for the others.
// Each pixel so has one surface, which light and histories treat as any; blend.frag mixes them for the eye (stochastic
// transparency, Enderton et al. 2010). The reference draws anew in each sample.
#pragma once
#include "interop.h"
#ifdef __cplusplus
#include <glm/glm.hpp>
namespace lambent {
using glm::floatBitsToUint;
} // namespace lambent
#endif
SHARED_BEGIN

/// Steps of a value from pixel to pixel, in 2^-32, so that any few neighbours have all of [0,1). Of 6000 random ones
/// those by which the share in 5 × 5, weighed by a tent, is nearest to alpha: 0.03 off, in tiles 0.04, as white noise
/// 0.12.
const uvec2 kLattices[32] = {
    uvec2(0x196696fdu, 0x4ca82608u), uvec2(0xe789c1b8u, 0x4cd9d19eu), uvec2(0xcc5d38ceu, 0xb1a02b29u),
    uvec2(0x31341fadu, 0xb42a3540u), uvec2(0xb2bc3be7u, 0xe7cdf86au), uvec2(0x4ba9cce5u, 0xcf206e20u),
    uvec2(0xb32aea4fu, 0xcab88214u), uvec2(0x59ba68a3u, 0x3398fcf0u), uvec2(0x33e2233bu, 0xa63def33u),
    uvec2(0x4dd9af21u, 0xe23e4758u), uvec2(0x99e76b94u, 0x406a1368u), uvec2(0x4f1c9c0eu, 0xc8d84eacu),
    uvec2(0xe475da88u, 0x66a0e8fcu), uvec2(0x98220c30u, 0xe525dbb6u), uvec2(0x328f267eu, 0x59ffe76bu),
    uvec2(0x591fdf63u, 0xc0bf5dd5u), uvec2(0x8c57ac3du, 0x32ec5f3cu), uvec2(0x177705fbu, 0xaf063665u),
    uvec2(0x413f7a61u, 0x66f09cb6u), uvec2(0x6387982eu, 0x193be92cu), uvec2(0x589fef39u, 0xde7bdec0u),
    uvec2(0x5106c72fu, 0x16bc4da1u), uvec2(0xe2a907a8u, 0xaf96ec5fu), uvec2(0x510cce21u, 0x6de83fabu),
    uvec2(0xaeef6885u, 0x15f0b976u), uvec2(0x3e4d5db6u, 0x50fe10d3u), uvec2(0x9415a107u, 0x52178578u),
    uvec2(0x92a05d37u, 0xaeacbf07u), uvec2(0x62539a80u, 0xe68efea7u), uvec2(0xc7f9c3cfu, 0x4e6ff4acu),
    uvec2(0x15ff31d6u, 0x497f542du), uvec2(0x900e04acu, 0x5b05f71eu)};

/// Mixes bits (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering": pcg3d, its first word).
SHARED_INLINE uint coverageHash(uint x, uint y, uint z) {
  x = x * 1664525u + 1013904223u;
  y = y * 1664525u + 1013904223u;
  z = z * 1664525u + 1013904223u;
  x += y * z;
  y += z * x;
  z += x * y;
  x ^= x >> 16;
  y ^= y >> 16;
  z ^= z >> 16;
  return x + y * z;
}

/// What a pixel or ray draws its chances by. 0 is none: of a ray, that its own bits give one.
const uint kOfPixel = 0x80000000u, kMeetsAll = 0xffffffffu, kMeetsNone = 0xfffffffeu;
/// `pixel` from the bottom left.
SHARED_INLINE uint pixelKey(uint x, uint y) { return kOfPixel | (y & 0x3fffu) << 14 | (x & 0x3fffu); }
SHARED_INLINE uint rayKey(vec3 origin, vec3 direction) {
  uint o = coverageHash(floatBitsToUint(origin.x), floatBitsToUint(origin.y), floatBitsToUint(origin.z));
  uint d = coverageHash(floatBitsToUint(direction.x), floatBitsToUint(direction.y), floatBitsToUint(direction.z));
  return coverageHash(o, d, 0u) >> 1;
}

/// Where a blended surface's alpha is nearer to 0 or 1 than this, it is taken for not there, or solid.
const float kLeastBlended = 1.0f / 255.0f;

/// Part of pixels and rays that meet a blended surface.
SHARED_INLINE float shareCovered(float alpha) {
  return alpha <= kLeastBlended ? 0.0f : alpha >= 1.0f - kLeastBlended ? 1.0f : alpha;
}

/// Whether a blended triangle (of its primitive) of an instance is there. Each draws anew, so that of several behind
/// one another each takes its share of what the others leave.
SHARED_INLINE bool isCovered(float alpha, uint key, uint instance, uint triangle) {
  if (alpha <= kLeastBlended || key == kMeetsNone) return alpha >= 1.0f - kLeastBlended;
  if (alpha >= 1.0f - kLeastBlended || key == kMeetsAll) return true;
  bool ofPixel = (key & kOfPixel) != 0u;
  uint x = key & 0x3fffu, y = (key >> 14) & 0x3fffu;
  // In each tile anew: panes behind one another would be the same stripes everywhere, and where two draw one lattice,
  // leave too much or little.
  uint chance = coverageHash(instance, triangle, ofPixel ? (y >> 4) << 10 | x >> 4 : key);
  if (ofPixel) {
    uvec2 steps = kLattices[chance & 31u];
    chance += x * steps.x + y * steps.y;
  }
  return alpha > float(chance >> 8) * (1.0f / 16777216.0f);
}

SHARED_END
