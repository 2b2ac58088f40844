#version 450
// Adds light that was traced on the CPU to what was gathered, texel by texel. Variant: GLOSSY.
layout(binding = 2) uniform sampler2D irradiance;
layout(location = 0) out vec4 outIrradiance;
#ifdef GLOSSY
layout(binding = 3) uniform sampler2D glossy;
layout(location = 1) out vec4 outGlossy;
#endif

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  outIrradiance = vec4(texelFetch(irradiance, texel, 0).rgb, 0.0);
#ifdef GLOSSY
  outGlossy = vec4(texelFetch(glossy, texel, 0).rgb, 0.0);
#endif
}
