#version 450
// Radiance towards the camera: emission + albedo/π · (direct + indirect irradiance), the sky where nothing is seen.
// Variants GLOSSY: with the receivers' lobes; DAYLIGHT: of the sky.
#include "lib/background.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
layout(binding = 8) uniform sampler2D directGlossy; // radiance over glossyTint
layout(binding = 9) uniform sampler2D indirectGlossy;
#endif
layout(binding = 2) uniform sampler2D albedo;
layout(binding = 3) uniform sampler2D emission;
layout(binding = 4) uniform sampler2D direct;
layout(binding = 5) uniform sampler2D indirect;
layout(location = 0) out vec4 outRadiance;

const float kInversePi = 0.318309886;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) {
    outRadiance = vec4(backgroundAt(pixel), 0.0);
    return;
  }
  vec3 emitted = texelFetch(emission, min(pixel, textureSize(emission, 0) - 1), 0).rgb;
  // Textures of one texel stand for a constant (black where a stage did not run).
  vec3 irradiance = texelFetch(direct, min(pixel, textureSize(direct, 0) - 1), 0).rgb +
                    texelFetch(indirect, min(pixel, textureSize(indirect, 0) - 1), 0).rgb;
  irradiance = mix(irradiance, vec3(0.0), lessThan(irradiance, vec3(0.0))); // noise of single frames; NaN stays
#ifdef GLOSSY
  vec3 glossy = texelFetch(directGlossy, min(pixel, textureSize(directGlossy, 0) - 1), 0).rgb +
                texelFetch(indirectGlossy, min(pixel, textureSize(indirectGlossy, 0) - 1), 0).rgb;
  vec3 reflected = reflectedAt(pixel, depth, irradiance, glossy);
#else
  vec3 reflected = texelFetch(albedo, pixel, 0).rgb * kInversePi * irradiance;
#endif
  outRadiance = vec4(emitted + reflected, 1.0);
}
