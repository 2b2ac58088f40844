#version 450
// Distance from the eye, metres, through the pixel's middle, and the triangle's normal on its side. Masks are cut out as rays find them: at the
// finest level, since a texel stands for the ray through its middle.
#ifdef ALPHA_MASK
#define FINEST_LEVEL
#include "lib/material.glsl"
layout(location = 2) in vec4 uv;
layout(location = 3) in vec4 color;
#endif
layout(location = 1) in vec3 positionEye;
layout(location = 0) out vec4 outDistanceNormal;
uniform mat4 wayFromPixel; // world axes, of window coordinates (x, y, 1)

void main() {
  vec3 normal = cross(dFdx(positionEye), dFdy(positionEye));
  float size = length(normal);
#ifdef ALPHA_MASK
  if (isCutOut(baseColorAt(uv, color).a)) discard;
#endif
  float distance = length(positionEye);
  normal = size > 0.0 ? normal / size : -positionEye / distance;
  // Corners are rounded to 1/256 of a pixel, and what is interpolated between them lies on the triangle's plane, but
  // beside the pixel's middle.
  vec3 way = normalize(mat3(wayFromPixel) * vec3(gl_FragCoord.xy, 1.0));
  float facing = dot(normal, way);
  if (size > 0.0 && abs(facing) > 1e-4) distance = dot(normal, positionEye) / facing;
  outDistanceNormal = vec4(distance, facing > 0.0 ? -normal : normal);
}
