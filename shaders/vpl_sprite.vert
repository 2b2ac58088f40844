#version 450
// A VPL as a point sprite, hidden where a surface lies before it.
#include "shared/camera_block.h"
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(location = 0) in vec4 positionHeat; // world position; heat: intensity as its rank in [0,1]
layout(location = 1) in float age;         // [0,1]: 0 new, 1 old
layout(location = 0) flat out float heat;
layout(location = 1) flat out float ageOut;
layout(location = 2) flat out float depthSprite;
uniform float diameterPixels;

void main() {
  gl_Position = camera.clipFromWorld * vec4(positionHeat.xyz, 1.0);
  gl_PointSize = diameterPixels;
  heat = positionHeat.w;
  ageOut = age;
  depthSprite = gl_Position.z / gl_Position.w;
}
