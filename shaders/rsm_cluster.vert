#version 450
// The finest clusters of all maps, one per vertex.
uniform int side;    // clusters per side of a map
uniform int columns; // of maps
flat out ivec2 texel; // of their mip level

void main() {
  int map = gl_VertexID / (side * side), at = gl_VertexID % (side * side);
  texel = side * ivec2(map % columns, map / columns) + ivec2(at % side, at / side);
}
