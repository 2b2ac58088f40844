#version 450
// Marks the patches that gather, in one pass over the flattened multiresolution buffer (paper 3, section 3.2.1): one that is
// not split while the next coarser is. Kept fragments set the stencil.
#include "shared/patches.h"

layout(binding = 0) uniform sampler2D gbufferDepth;
layout(binding = 1) uniform sampler2D planes; // level i: patches of 2^(i+1) pixels
layout(binding = 2) uniform sampler2D normalsLo;
uniform ivec2 base;    // size of level 0, texels
uniform int coarsest;  // level
uniform int grid;      // see shared/patches.h
uniform int gridLevel; // log2(grid)
uniform ivec2 size;    // of the image, pixels

bool split(int level, ivec2 texel) { return texelFetch(normalsLo, texel, level + gridLevel - 1).a > 0.5; }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int level = 0;
  if (at.x >= base.x) {
    at.x -= base.x;
    for (level = 1; level <= coarsest && at.y >= base.y >> level; ++level) at.y -= base.y >> level;
    if (level > coarsest || at.x >= base.x >> level) discard;
  }
  ivec2 sub = base / grid >> level;
  ivec2 subset = at / sub, texel = at - subset * sub;
  if (any(greaterThanEqual(texel * (1 << level) * grid + subset, size))) discard;
  if (level < coarsest && !split(level + 1, texel >> 1)) discard;
  if (level == 0) {
    if (texelFetch(gbufferDepth, texel * grid + subset, 0).r == 0.0) discard;
  } else if (split(level, texel) || texelFetch(planes, texel, level + gridLevel - 1).x <= 0.0) {
    discard;
  }
}
