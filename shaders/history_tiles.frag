#version 450
// By how much light changes in each tile of 16×16 pixels: the sum of the differences between this frame and what was kept,
// in which their noise cancels out, over the sum of the larger of the two; luminance.
layout(binding = 2) uniform sampler2D kept;
layout(binding = 3) uniform sampler2D change; // this frame - kept
layout(location = 0) out vec4 outShare;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * 16, end = min(first + 16, textureSize(kept, 0));
  vec3 before = vec3(0.0), difference = vec3(0.0);
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) {
      before += texelFetch(kept, ivec2(x, y), 0).rgb;
      difference += texelFetch(change, ivec2(x, y), 0).rgb;
    }
  const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);
  float largest = dot(kLuminance, max(before, before + difference));
  outShare = vec4(largest > 0.0 ? dot(kLuminance, abs(difference)) / largest : 0.0);
}
