#version 450
// Image-space radiosity's clusters in one pass (paper 3, section 3.4): of all finest clusters those survive that are the
// first of a patch without discontinuity, which they stand for, and that reflect light.
layout(points) in;
layout(points, max_vertices = 1) out;
#include "lib/rsm_light.glsl"

layout(binding = 0) uniform sampler2D positions; // see ReflectiveMaps
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D fluxes;
layout(binding = 3) uniform sampler2D normalsLo; // PatchPyramid
uniform int finest;   // mip levels
uniform int coarsest;
flat in ivec2 texel[];

bool split(int level) {
  return level > finest && texelFetch(normalsLo, texel[0] >> (level - finest), level - 1).a > 0.5;
}

void main() {
  for (int level = finest; level <= coarsest; ++level) {
    int shift = level - finest;
    if (any(notEqual(texel[0] & ((1 << shift) - 1), ivec2(0)))) return; // another one stands for the patches from here on
    if (level < coarsest && !split(level + 1)) continue;
    if (split(level)) return;
    ivec2 at = texel[0] >> shift;
    vec4 flux = texelFetch(fluxes, at, level);
    if (setLight(texelFetch(positions, at, level).xyz, texelFetch(normals, at, level).xyz, flux.rgb, flux.a)) EmitVertex();
    return;
  }
}
