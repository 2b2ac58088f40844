// Which pixel a fragment of a gather finds light for. One draw covers one 4×4 subset of the pixels, which lie side by side,
// or all pixels (stride 1). Variant PATCHES: fragments are patches of one level of the multiresolution buffer, those that
// the stencil marks. After lib/gbuffer.glsl.
#include "patch_sample.glsl"

uniform ivec2 tileOrigin; // of this draw's sub-image, pixels
uniform ivec2 subset;     // (x mod 4, y mod 4) of its pixels
uniform int stride;       // 4, or 1 for all pixels
uniform int level;        // of the patches
#ifdef PATCHES
layout(early_fragment_tests) in;
#endif

ivec2 gatheredPixel() {
#ifdef PATCHES
  return patchSample(ivec2(gl_FragCoord.xy) - tileOrigin, level, stride, subset);
#else
  return (ivec2(gl_FragCoord.xy) - tileOrigin) * stride + subset;
#endif
}
