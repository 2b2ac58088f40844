#version 450
// Contact sheet of paraboloid maps: near is bright, nothing met is black, outside the disc is dark blue.
layout(binding = 0) uniform sampler2DArray maps;
uniform ivec2 grid;   // maps per row and column
uniform float cellPixels;
uniform int count;    // maps to show
layout(location = 0) out vec4 outColor;

void main() {
  vec2 place = gl_FragCoord.xy / cellPixels;
  ivec2 cell = ivec2(place);
  int layer = (grid.y - 1 - cell.y) * grid.x + cell.x; // first map at the top left
  vec2 uv = fract(place);
  outColor = vec4(0.0, 0.0, 0.0, 1.0);
  if (cell.x >= grid.x || cell.y >= grid.y || layer >= count) return;
  float value = texelFetch(maps, ivec3(ivec2(uv * vec2(textureSize(maps, 0).xy)), layer), 0).r;
  vec2 centred = uv * 2.0 - 1.0;
  outColor.rgb = dot(centred, centred) > 1.0 ? vec3(0.0, 0.0, 0.15) : vec3(1.0 - value) * float(value < 1.0);
}
