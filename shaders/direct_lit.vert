#version 450
// A pixel and a direct light that rays found to see one another, as a point.
// r: pixel, as ShadowDoubt's; g: light, and in the upper 8 bits what part of its light passes blended surfaces.
layout(binding = 3) uniform usamplerBuffer litPairs;
uniform int firstPair;
uniform int firstLight; // of the block
uniform vec2 frameSize;
layout(location = 0) flat out int litLight;
layout(location = 1) flat out float litTransmittance;

void main() {
  uvec2 pair = texelFetch(litPairs, firstPair + gl_VertexID).rg;
  vec2 pixel = vec2(pair.r & 0xffffu, pair.r >> 16) + 0.5;
  gl_Position = vec4(pixel / frameSize * 2.0 - 1.0, 0.0, 1.0);
  litLight = int(pair.g & 0xffffffu) - firstLight;
  litTransmittance = float(pair.g >> 24) / 255.0;
}
