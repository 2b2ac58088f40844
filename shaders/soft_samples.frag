#version 450
// How many samples more than the others a pixel takes in the next frame, over 255: as many as bring the noise of its
// mean down to kNoise, where that mean is worth few frames. Noise is that of frames which may have had more samples
// before, so their number settles below. Glossy noise asks for none.
#include "lib/variance.glsl"

layout(binding = 2) uniform sampler2D irradiance; // denoised
layout(binding = 3) uniform sampler2D variance;   // HistoryPass::variance
layout(binding = 4) uniform sampler2D worth;      // HistoryPass::worth
uniform float samples, mostSamples; // of a pixel in a frame
layout(location = 0) out float outMore;

const float kEnough = 8.0; // frames
const float kNoise = 0.03; // standard deviation over the mean

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outMore = 0.0;
  float frames = texelFetch(worth, pixel, 0).a;
  float noise = texelFetch(variance, pixel, 0).r;
  if (!(frames > 0.0 && noise > 0.0)) return;
  float light = kNoise * dot(kLuminance, texelFetch(irradiance, pixel, 0).rgb);
  float wanted = samples * min(kEnough, noise / max(light * light, 1e-30)) / frames;
  outMore = floor(clamp(wanted - samples, 0.0, mostSamples - samples)) / 255.0;
}
