#version 450
// Mixes pixels where blended surfaces are, of which each shows one of those behind one another (shared/coverage.h).
#include "shared/coverage.h"
layout(binding = 2) uniform sampler2D radiance;
layout(binding = 3) uniform sampler2D blended; // 1 where such surfaces are
layout(location = 0) out vec4 outRadiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(radiance, 0) - 1;
  outRadiance = texelFetch(radiance, pixel, 0);
  if (texelFetch(blended, pixel, 0).r == 0.0) return;
  vec4 sum = vec4(0.0);
  for (int y = -kMixReach; y <= kMixReach; ++y)
    for (int x = -kMixReach; x <= kMixReach; ++x) {
      ivec2 at = pixel + ivec2(x, y);
      if (any(notEqual(at, clamp(at, ivec2(0), last))) || texelFetch(blended, at, 0).r == 0.0) continue;
      sum += vec4(texelFetch(radiance, at, 0).rgb, 1.0) * mixWeight(vec2(x, y));
    }
  outRadiance.rgb = sum.rgb / sum.a;
}
