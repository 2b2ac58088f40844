#version 450
// Subsplats on their way through a pass of refinement. FIRST: all patches of the coarsest level.
#ifdef FIRST
uniform ivec2 side; // patches at the coarsest level
uniform int coarsest;
#else
layout(location = 0) in ivec3 patchIn;
#endif
flat out ivec3 subsplat; // texel and level

void main() {
#ifdef FIRST
  subsplat = ivec3(gl_VertexID % side.x, gl_VertexID / side.x, coarsest);
#else
  subsplat = patchIn;
#endif
}
