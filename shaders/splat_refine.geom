#version 450
// Refines a list of subsplats by one level (paper 2, section 3.3): one of this level that is to be split gives way to its
// four parts, others pass. What shows no surface ends here. Variant PER_VPL: also split where the light of one VPL differs
// within the patch (paper 2, section 4.1), as glossy surfaces need.
layout(points) in;
layout(points, max_vertices = 4) out;
#include "lib/gbuffer.glsl"
#include "lib/patch_sample.glsl"
#ifdef PER_VPL
#include "lib/vpl_shading.glsl"
#endif

layout(binding = 3) uniform sampler2D planes; // PatchPyramid
layout(binding = 4) uniform sampler2D normalsLo;
uniform int level; // that is looked at
#ifdef PER_VPL
uniform int light;
uniform int layer;
uniform float lightThreshold; // MultiresSettings::light
#endif
flat in ivec3 subsplat[];
flat out ivec3 patchOut;

/// Whether the patch shows a surface.
bool shows(ivec2 texel, int at) {
  ivec2 size = ivec2(camera.size.xy);
  if (any(greaterThanEqual(texel * (1 << at), size))) return false;
  if (at == 0) return texelFetch(gbufferDepth, texel, 0).r > 0.0;
  return texelFetch(planes, texel, at - 1).x > 0.0;
}

#ifdef PER_VPL
/// Whether the four parts receive different light, relative to what the VPL would bring to a surface that faces it.
bool differs(ivec2 texel, int at) {
  vec3 lo = vec3(1e30), hi = vec3(0.0);
  VplLight vpl = lights[light];
  for (int k = 0; k < 4; ++k) {
    ivec2 pixel = patchSample(texel * 2 + ivec2(k & 1, k >> 1), at - 1, 1, ivec2(0));
    float depth = texelFetch(gbufferDepth, pixel, 0).r;
    if (depth == 0.0) continue;
    Surface surface = surfaceAt(pixel, depth);
    Received received = receivedNothing();
    receive(received, surface, vpl, layer, 1.0);
    vec3 fromLight = surface.position - vpl.positionArea.xyz;
    vec3 facing = vpl.powerNormalX.rgb / (dot(fromLight, fromLight) + vpl.positionArea.w * diskFactor);
    vec3 seen = received.irradiance;
#ifdef GLOSSY
    seen = surface.receiver.diffuse * seen + 3.14159265 * received.glossy;
#endif
    seen /= max(facing, vec3(1e-30));
    lo = min(lo, seen);
    hi = max(hi, seen);
  }
  vec3 range = hi - lo;
  return max(max(range.x, range.y), range.z) > lightThreshold;
}
#endif

void pass(ivec2 texel, int at) {
  patchOut = ivec3(texel, at);
  EmitVertex();
  EndPrimitive();
}

void main() {
  ivec2 texel = subsplat[0].xy;
  int at = subsplat[0].z;
  if (at != level) {
    pass(texel, at);
    return;
  }
  if (!shows(texel, at)) return;
  bool split = level > 0 && texelFetch(normalsLo, texel, at - 1).a > 0.5;
#ifdef PER_VPL
  split = split || (level > finestPatch && differs(texel, at));
#endif
  if (!split) {
    pass(texel, at);
    return;
  }
  for (int k = 0; k < 4; ++k) {
    ivec2 part = texel * 2 + ivec2(k & 1, k >> 1);
    if (shows(part, at - 1)) pass(part, at - 1);
  }
}
