#version 450
// What an image asks for as exposure (engine/image/exposure.h), summed over the pixels of each cell of a grid.
#include "lib/variance.glsl"

layout(binding = 2) uniform sampler2D radiance; // a = 1 on surfaces
uniform ivec2 grid;                             // cells
uniform float dark;                             // luminance that has half a weight
layout(location = 0) out vec4 outSums;

void main() {
  ivec2 size = textureSize(radiance, 0), cell = ivec2(gl_FragCoord.xy);
  ivec2 begin = size * cell / grid, end = size * (cell + 1) / grid;
  outSums = vec4(0.0);
  for (int y = begin.y; y < end.y; ++y)
    for (int x = begin.x; x < end.x; ++x) {
      vec4 texel = texelFetch(radiance, ivec2(x, y), 0);
      float light = dot(kLuminance, texel.rgb);
      if (!(texel.a > 0.0 && light > 0.0) || isinf(light)) continue;
      float relative = dark / light, weight = 1.0 / (1.0 + relative * relative);
      outSums += vec4(weight * log(light), weight, sqrt(light), 1.0);
    }
}
