#version 450
// One subsplat of one VPL: a point over its texel of the multiresolution buffer (paper 2, section 3.4).
#include "shared/patches.h"
#include "shared/vpl_light.h"

layout(location = 0) in ivec3 patchIn;
uniform ivec2 base;       // of the atlas's level 0
uniform vec2 inverseSize; // of the atlas
uniform int perClass;     // lights of each class of the block
uniform int firstLight;   // of the block; then every instance the next
flat out ivec3 subsplat;
flat out int light; // in the block

void main() {
  subsplat = patchIn;
  int index = firstLight + gl_InstanceID;
  light = index / perClass * kLightsPerClass + index % perClass;
  vec2 at = vec2(atlasOrigin(base, patchIn.z) + patchIn.xy) + 0.5;
  gl_Position = vec4(at * inverseSize * 2.0 - 1.0, 0.5, 1.0);
}
