#version 450
// Adds light that was found elsewhere, on the CPU for one, texel by texel. Variants: SUBSETS (the target is
// de-interleaved, what is added is not), GLOSSY.
#include "lib/light_outputs.glsl"
layout(binding = 2) uniform sampler2D irradiance;
#ifdef GLOSSY
layout(binding = 3) uniform sampler2D glossy;
#endif
uniform ivec2 tileSize; // of the target's sub-images

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
#ifdef SUBSETS
  texel = (texel % tileSize) * 4 + texel / tileSize;
#endif
  outIrradiance = vec4(texelFetch(irradiance, texel, 0).rgb, 0.0);
#ifdef GLOSSY
  outGlossy = vec4(texelFetch(glossy, texel, 0).rgb, 0.0);
#endif
}
