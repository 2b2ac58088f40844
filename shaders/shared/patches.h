// The multiresolution buffer: where a patch of the image lies in it, and which pixel stands for the patch.
// The image is `grid` × `grid` sub-images (1: the image itself; 4: the subsets of interleaved sampling) of
// `base` / grid texels each, padded so that all levels divide evenly. A texel of level l stands for 2^l × 2^l pixels of its
// sub-image. Level 0 fills the left of the atlas, the others are stacked next to it.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// First texel of a level in the atlas; `base` is the size of level 0.
SHARED_INLINE ivec2 atlasOrigin(ivec2 base, int level) {
  return level == 0 ? ivec2(0, 0) : ivec2(base.x, base.y - (base.y >> (level - 1)));
}

SHARED_INLINE ivec2 atlasSize(ivec2 base, int levels) { return ivec2(levels > 0 ? base.x + base.x / 2 : base.x, base.y); }

/// Pixel of the sub-image, from its corner, that a patch is gathered at: the one above and right of its centre.
SHARED_INLINE ivec2 patchCentre(ivec2 texel, int level) {
  int middle = (1 << level) / 2;
  return texel * (1 << level) + ivec2(middle, middle);
}

/// The same as a pixel of the image, of `size` pixels; the last that the sub-image has where the centre lies outside.
/// Outside the image for a sub-image without pixels.
SHARED_INLINE ivec2 patchPixel(ivec2 texel, int level, int grid, ivec2 subset, ivec2 size) {
  ivec2 last = (size - ivec2(1, 1) - subset) / grid;
  return min(patchCentre(texel, level), last) * grid + subset;
}

SHARED_END
