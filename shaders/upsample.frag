#version 450
// One level of the multiresolution buffer made whole, from coarse to fine (paper 2, section 3.5): where a patch was gathered
// at this level it stays; where it belongs to a coarser one, that level is interpolated; where it is split it stays empty.
// What is interpolated holds light and lies on the same surface: weights as in filter.frag. A neighbour that was split
// counts with its parts. Weights are divided by their sum, so a constant stays one. FINAL: to the pixels themselves.
#include "lib/gbuffer.glsl"
#include "shared/patches.h"

layout(binding = 2) uniform sampler2D atlas;  // as gathered; a > 0: holds light
layout(binding = 3) uniform sampler2D coarse; // the next coarser level, whole; a as above
uniform ivec2 base;   // of the atlas's level 0
uniform int level;    // that is made
uniform int coarsest;
uniform int grid;
uniform ivec2 tile;   // FINAL: size of a sub-image of the target, which is not padded
uniform float normalPower;
uniform float distanceSigma; // share of the view distance
uniform float detail;        // FINAL: MultiresSettings::detail
layout(location = 0) out vec4 outIrradiance;

vec3 normal, position;
float inverseSigma;

/// How much of the light at `pixel` is meant for this patch's surface.
float alike(ivec2 pixel) {
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return 0.0;
  float height = dot(normal, positionFromDepth(pixel, depth) - position) * inverseSigma;
  float alignment = max(dot(normal, texelFetch(gbufferNormal, pixel, 0).xyz), 1e-4);
  return exp2(normalPower * log2(alignment) - 0.7213475 * height * height);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 size = ivec2(camera.size.xy);
  outIrradiance = vec4(0.0);
  ivec2 sub = base / grid >> level;
#ifdef FINAL
  ivec2 subset = at / tile, texel = at - subset * tile;
  ivec2 pixel = texel * grid + subset;
  if (any(greaterThanEqual(pixel, size))) return;
#else
  ivec2 subset = at / sub, texel = at - subset * sub;
  ivec2 pixel = patchPixel(texel, level, grid, subset, size);
  if (any(greaterThanEqual(texel * (1 << level) * grid + subset, size))) return;
#endif
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  ivec2 origin = atlasOrigin(base, level) + subset * sub;
  vec4 own = texelFetch(atlas, origin + texel, 0);
  normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  position = positionFromDepth(pixel, depth);
  if (own.a > 0.0) {
    outIrradiance = vec4(own.rgb, 1.0);
  } else if (level < coarsest) {
    ivec2 subCoarse = sub >> 1, parent = texel >> 1;
    if (texelFetch(coarse, subset * subCoarse + parent, 0).a == 0.0) return; // gathered in parts
    inverseSigma = 1.0 / (distanceSigma * viewDistanceFromDepth(camera, depth));
    vec2 offset = vec2(patchCentre(texel, level) - patchCentre(parent, level + 1)) / float(2 << level);
    vec2 share = abs(offset);
    ivec2 side = ivec2(sign(offset));
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; ++i) {
      ivec2 step = ivec2(i & 1, i >> 1);
      vec2 linear = mix(1.0 - share, share, vec2(step));
      float weight = linear.x * linear.y;
      ivec2 q = parent + step * side;
      if (weight == 0.0 || any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, subCoarse))) continue;
      vec4 value = texelFetch(coarse, subset * subCoarse + q, 0);
      if (value.a > 0.0) {
        weight *= max(alike(patchPixel(q, level + 1, grid, subset, size)), i == 0 ? 1e-3 : 0.0);
        sum += weight * value.rgb;
        weights += weight;
        continue;
      }
      vec3 partSum = vec3(0.0);
      float partWeights = 0.0, parts = 0.0;
      for (int k = 0; k < 4; ++k) {
        ivec2 part = q * 2 + ivec2(k & 1, k >> 1);
        vec4 light = texelFetch(atlas, origin + part, 0);
        if (light.a == 0.0) continue;
        float likeness = alike(patchPixel(part, level, grid, subset, size));
        partSum += likeness * light.rgb;
        partWeights += likeness;
        parts += 1.0;
      }
      if (parts == 0.0) continue;
      sum += weight / parts * partSum;
      weights += weight / parts * partWeights;
    }
    outIrradiance = vec4(sum / weights, 1.0);
  }
#ifdef FINAL
  vec3 towardsViewer = camera.lens.w > 0.0 ? camera.worldFromView[2].xyz
                                           : normalize(camera.worldFromView[3].xyz - position);
  outIrradiance.rgb *= detail * max(dot(towardsViewer, normal), 0.0) + 1.0 - detail;
#endif
}
