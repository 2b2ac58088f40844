#version 450
// Where a surface is that neither hides all nor nothing of what is behind it.
#include "lib/material.glsl"
#include "shared/coverage.h"
layout(location = 2) in vec4 uv;
layout(location = 3) in vec4 color;
layout(location = 0) out float outBlended;

void main() {
  float alpha = baseColorAt(uv, color).a;
  if (!(alpha > kLeastBlended && alpha < 1.0 - kLeastBlended)) discard;
  outBlended = 1.0;
}
