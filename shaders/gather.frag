#version 450
// Irradiance from VPLs (or samples of emissive surfaces): E = Σ L·a·cosx·cosy/(r² + disk·a/π)·V.
// Variants of lib/gathered_pixel.glsl and lib/vpl_shading.glsl; LISTS: the lights that the pixel's tile has chosen.
#include "lib/gbuffer.glsl"
#include "lib/vpl_shading.glsl"
#include "lib/gathered_pixel.glsl"
#include "lib/light_outputs.glsl"
#ifdef CHECKED
#include "shared/octahedral.h"
#endif

uniform int firstClass;     // in the block
uniform int classCount;
uniform int blockClass;     // class that the block starts with
uniform int perClass;       // lights in each class
uniform float scale;        // 16 for one class of 16, 1 for all, and for lists
#ifdef LISTS
layout(binding = 4) uniform usampler2D lists; // LightLists::texture
uniform int listTile;    // pixels
uniform int tilesAcross;
uniform int firstTexel;  // of this draw's class
uniform int chunk, chunks;
#endif
#ifdef CHECKED
uniform int turn; // another one for each frame of those that are averaged, and each 2048 lights
#ifdef GLOSSY
layout(location = 2) out uvec4 outDrawn; // as DrawnPair in gi/gather/map_checks.cpp
#else
layout(location = 1) out uvec4 outDrawn;
#endif

/// Uniform in [0, 1), evenly spread over neighbours and over frames (additive recurrences, Roberts 2018).
float numberOf(uvec2 pixel) {
  uint bits = pixel.x * 3242174889u + pixel.y * 2447445414u + uint(turn) * 2654435769u;
  return float(bits >> 8) / 16777216.0;
}
#endif

void main() {
  ivec2 pixel = gatheredPixel();
  writeNoLight();
#ifdef CHECKED
  outDrawn = uvec4(0u);
#endif
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return;
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  Surface surface = surfaceAt(pixel, depth);
  Received sum = receivedNothing();
#ifdef CHECKED
  sum.number = numberOf(uvec2(pixel));
#endif
#ifdef LISTS
  ivec2 tile = pixel / listTile;
  int row = tile.y * tilesAcross + tile.x;
  int begin = chunk == 0 ? 0 : int(texelFetch(lists, ivec2(firstTexel + chunk - 1, row), 0).r);
  int end = int(texelFetch(lists, ivec2(firstTexel + chunk, row), 0).r);
  for (int i = begin; i < end; ++i) {
    uint entry = texelFetch(lists, ivec2(firstTexel + chunks + i, row), 0).r;
    int slot = int(entry & 0xffffu);
    int at = chunk * kLightClasses * kLightsPerClass + (slot % kLightClasses) * kLightsPerClass + slot / kLightClasses;
    receive(sum, surface, lightAt(at), slot, unpackHalf2x16(entry >> 16).x);
  }
#else
  for (int c = firstClass; c < firstClass + classCount; ++c)
    for (int i = 0; i < perClass; ++i)
      receive(sum, surface, lights[c * kLightsPerClass + i], i * kLightClasses + blockClass + c, 1.0);
#endif
  outIrradiance = vec4(sum.irradiance * scale, 1.0);
#ifdef CHECKED
  float gain = sum.drawn > 0.0 ? scale * sum.term * sum.unseen / sum.drawn : 0.0;
  outDrawn = uvec4(uint(sum.layer), floatBitsToUint(gain), floatBitsToUint(viewDistanceFromDepth(camera, depth)),
                   packSnorm2x16(octahedralFromUnit(surface.normal)));
#endif
#ifdef GLOSSY
  outGlossy = vec4(sum.glossy * scale / surface.tint, 1.0);
#endif
}
