#version 450
// The light of one VPL at one patch, to be added up. Variants of lib/vpl_shading.glsl.
#include "lib/light_outputs.glsl"
#include "lib/vpl_shading.glsl"
#include "lib/patch_sample.glsl"

uniform int blockClass; // class that the block starts with
flat in ivec3 subsplat;
flat in int light;

void main() {
  ivec2 pixel = patchSample(subsplat.xy, subsplat.z, 1, ivec2(0));
  Surface surface = surfaceAt(pixel, texelFetch(gbufferDepth, pixel, 0).r);
  Received sum = receivedNothing();
  int layer = light % kLightsPerClass * kLightClasses + blockClass + light / kLightsPerClass;
  receive(sum, surface, lights[light], layer, 1.0);
  outIrradiance = vec4(sum.irradiance, 1.0);
#ifdef GLOSSY
  outGlossy = vec4(sum.glossy / surface.tint, 1.0);
#endif
}
