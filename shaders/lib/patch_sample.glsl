// Which pixel stands for a patch. After lib/gbuffer.glsl.
#include "shared/patches.h"

uniform int finestPatch; // level: patches up to here need not be smooth

/// As patchPixel; where that one shows nothing, the first of the patch that does.
ivec2 patchSample(ivec2 texel, int level, int grid, ivec2 subset) {
  ivec2 size = ivec2(camera.size.xy), centre = patchPixel(texel, level, grid, subset, size);
  if (level == 0 || level > finestPatch || any(greaterThanEqual(centre, size))) return centre;
  if (texelFetch(gbufferDepth, centre, 0).r > 0.0) return centre;
  int side = 1 << level;
  for (int i = 0; i < side * side; ++i) {
    ivec2 pixel = (texel * side + ivec2(i % side, i / side)) * grid + subset;
    if (all(lessThan(pixel, size)) && texelFetch(gbufferDepth, pixel, 0).r > 0.0) return pixel;
  }
  return centre;
}
