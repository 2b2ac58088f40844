#version 450
// One technique's indirect light mixed into another's. Variant: GLOSSY.
#include "lib/light_outputs.glsl"
layout(binding = 2) uniform sampler2D irradianceA;
layout(binding = 4) uniform sampler2D irradianceB;
uniform float share; // of B
#ifdef GLOSSY
layout(binding = 3) uniform sampler2D glossyA;
layout(binding = 5) uniform sampler2D glossyB;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 b = texelFetch(irradianceB, pixel, 0);
  float part = share * b.a; // it knows nothing of some pixels
  outIrradiance = vec4(mix(texelFetch(irradianceA, pixel, 0).rgb, b.rgb, part), 1.0);
#ifdef GLOSSY
  outGlossy = mix(texelFetch(glossyA, pixel, 0), texelFetch(glossyB, pixel, 0), part);
#endif
}
