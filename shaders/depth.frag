#version 450
// Depth alone; only the alpha-tested variant has anything to do.
#ifdef ALPHA_MASK
#include "lib/material.glsl"
layout(location = 2) in vec4 uv;
layout(location = 3) in vec4 color;
#endif

void main() {
#ifdef ALPHA_MASK
  if (isCutOut(baseColorAt(uv, color).a)) discard;
#endif
}
