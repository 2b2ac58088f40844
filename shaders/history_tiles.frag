#version 450
// By how much light changes in each tile of 16×16 pixels, in luminance. r: the sum of the differences between this
// frame and what was kept, in which their noise cancels out, over the sum of the larger of the two. g: what noise makes
// of it. b: mean square of the differences.
#include "lib/variance.glsl"

layout(binding = 2) uniform sampler2D kept;
layout(binding = 3) uniform sampler2D change; // this frame - kept
layout(location = 0) out vec4 outShare;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * 16, end = min(first + 16, textureSize(kept, 0));
  vec3 before = vec3(0.0), difference = vec3(0.0);
  float squares = 0.0, seen = 0.0;
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) {
      before += texelFetch(kept, ivec2(x, y), 0).rgb;
      vec4 here = texelFetch(change, ivec2(x, y), 0);
      difference += here.rgb;
      seen += float(here.a > 0.0);
      float brightness = dot(kLuminance, here.rgb);
      squares += brightness * brightness;
    }
  float largest = dot(kLuminance, max(before, before + difference));
  float share = 0.0, noise = 0.0;
  if (largest > 0.0) share = dot(kLuminance, abs(difference)) / largest, noise = sqrt(squares) / largest;
  outShare = vec4(share, noise, squares / max(seen, 1.0), 0.0);
}
