#version 450
// What a surface that neither hides all nor nothing lets through, and whether the pixel shows it. Multiplied over all
// before what is solid.
#include "lib/material.glsl"
layout(location = 2) in vec4 uv;
layout(location = 3) in vec4 color;
layout(location = 0) out vec2 outThrough; // share let through; 0 where it is shown

void main() {
  float alpha = baseColorAt(uv, color).a;
  if (!(alpha > kLeastBlended && alpha < 1.0 - kLeastBlended)) discard;
  outThrough = vec2(1.0 - alpha, isCutOut(alpha) ? 1.0 : 0.0);
}
