#version 450
// Light into a rectangle of a host's texture (gi/library/deliver.h).
layout(binding = 0) uniform sampler2D light; // rows from the bottom
uniform ivec2 corner;                        // of the rectangle
uniform int height, originTop, lit;
layout(location = 0) out vec4 outLight;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
  if (originTop != 0) pixel.y = height - 1 - pixel.y;
  outLight = vec4(lit != 0 ? texelFetch(light, pixel, 0).rgb : vec3(0.0), 1.0);
}
