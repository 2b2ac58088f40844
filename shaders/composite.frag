#version 450
// Radiance towards the camera: emission + albedo/π · (direct + indirect irradiance), the sky where nothing is seen.
layout(binding = 0) uniform sampler2D gbufferDepth;
layout(binding = 2) uniform sampler2D albedo;
layout(binding = 3) uniform sampler2D emission;
layout(binding = 4) uniform sampler2D direct;
layout(binding = 5) uniform sampler2D indirect;
uniform vec3 skyRadiance;
layout(location = 0) out vec4 outRadiance;

const float kInversePi = 0.318309886;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (texelFetch(gbufferDepth, pixel, 0).r == 0.0) {
    outRadiance = vec4(skyRadiance, 0.0);
    return;
  }
  // Textures of one texel stand for a constant (black where a stage did not run).
  vec3 irradiance = texelFetch(direct, min(pixel, textureSize(direct, 0) - 1), 0).rgb +
                    texelFetch(indirect, min(pixel, textureSize(indirect, 0) - 1), 0).rgb;
  vec3 reflected = texelFetch(albedo, pixel, 0).rgb * kInversePi * irradiance;
  outRadiance = vec4(texelFetch(emission, pixel, 0).rgb + reflected, 1.0);
}
