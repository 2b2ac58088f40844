#version 450
// Disc: intensity from blue over green to red. Ring: age, white when new, black when old.
layout(binding = 0) uniform sampler2D gbufferDepth;
layout(location = 0) flat in float heat;
layout(location = 1) flat in float ageOut;
layout(location = 2) flat in float depthSprite;
layout(location = 0) out vec4 outColor;

void main() {
  float radius = length(gl_PointCoord - 0.5) * 2.0;
  if (radius > 1.0) discard;
  // A VPL lies on its surface: 1 % of the distance separates "on" from "behind".
  if (depthSprite < texelFetch(gbufferDepth, ivec2(gl_FragCoord.xy), 0).r * 0.99) discard;
  vec3 disc = clamp(vec3(heat * 4.0 - 2.0, 2.0 - abs(heat * 4.0 - 2.0), 2.0 - heat * 4.0), 0.0, 1.0);
  outColor = vec4(radius > 0.6 ? vec3(1.0 - ageOut) : disc, 1.0);
}
