#version 450
// A finished image, scaled to the target; SPLIT: another one right of the divider.
layout(binding = 0) uniform sampler2D leftImage; // already display-encoded, bilinear
uniform vec2 targetSize;
#ifdef SPLIT
layout(binding = 1) uniform sampler2D rightImage; // likewise
uniform float divider;                       // pixels of the target, from the left
#endif
layout(location = 0) out vec4 outColor;

void main() {
  vec2 at = gl_FragCoord.xy / targetSize;
#ifdef SPLIT
  const float kHalfLine = 1.0; // pixels
  float beyond = gl_FragCoord.x - divider;
  vec4 left = texture(leftImage, at), right = texture(rightImage, at);
  outColor = abs(beyond) < kHalfLine ? vec4(1.0) : vec4(beyond > 0.0 ? right.rgb : left.rgb, 1.0);
#else
  outColor = vec4(texture(leftImage, at).rgb, 1.0);
#endif
}
