#version 450
// Adds light that was found elsewhere, on the CPU for one, texel by texel. Variant: GLOSSY.
#include "lib/light_outputs.glsl"
layout(binding = 2) uniform sampler2D irradiance;
#ifdef GLOSSY
layout(binding = 3) uniform sampler2D glossy;
#endif

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  outIrradiance = vec4(texelFetch(irradiance, texel, 0).rgb, 0.0);
#ifdef GLOSSY
  outGlossy = vec4(texelFetch(glossy, texel, 0).rgb, 0.0);
#endif
}
