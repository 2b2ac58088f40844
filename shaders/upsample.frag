#version 450
// One level of the multiresolution buffer made whole, from coarse to fine (paper 2, section 3.5): where a patch was gathered
// at this level it stays; where it belongs to a coarser one, that level is interpolated; where it is split it stays empty.
// What is interpolated holds light and lies on the same surface: weights as in lib/surface_weight.glsl. A neighbour that was split
// counts with its parts. Weights are divided by their sum, so a constant stays one. FINAL: to the pixels themselves. GLOSSY:
// glossy light too, with weights by roughness and metalness as well. BILINEAR: without weights for surfaces, and between
// whole patches only, as the paper.
#include "lib/gbuffer.glsl"
#include "lib/light_outputs.glsl"
#include "lib/patch_sample.glsl"

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
#ifdef GLOSSY
layout(binding = 4) uniform sampler2D atlasGlossy; // as irradiance, in the same places
layout(binding = 5) uniform sampler2D coarseGlossy;
#include "lib/lobe_shape.glsl"
layout(binding = 7) uniform sampler2D gbufferFinish;

vec4 shape;

float likeLobe(ivec2 pixel) {
#ifdef BILINEAR
  return 1.0;
#endif
  return finishWeight(shape, shapeOfLobe(texelFetch(gbufferFinish, pixel, 0), kLeastVplRoughness));
}
#endif

vec3 normal, position;
float inverseSigma;

/// How much of the light at `pixel` is meant for this patch's surface.
float alike(ivec2 pixel) {
#ifdef BILINEAR
  return 1.0;
#endif
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return 0.0;
  float height = dot(normal, positionFromDepth(pixel, depth) - position) * inverseSigma;
  float alignment = max(dot(normal, texelFetch(gbufferNormal, pixel, 0).xyz), 1e-4);
  return exp2(normalPower * log2(alignment) - 0.7213475 * height * height);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 size = ivec2(camera.size.xy);
  writeNoLight();
  ivec2 sub = base / grid >> level;
#ifdef FINAL
  ivec2 subset = at / tile, texel = at - subset * tile;
  ivec2 pixel = texel * grid + subset;
  if (any(greaterThanEqual(pixel, size))) return;
#else
  ivec2 subset = at / sub, texel = at - subset * sub;
  ivec2 pixel = patchSample(texel, level, grid, subset);
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
#ifdef GLOSSY
    outGlossy = texelFetch(atlasGlossy, origin + texel, 0);
#endif
  } else if (level < coarsest) {
    ivec2 subCoarse = sub >> 1, parent = texel >> 1;
    if (texelFetch(coarse, subset * subCoarse + parent, 0).a == 0.0) return; // gathered in parts
    inverseSigma = 1.0 / (distanceSigma * viewDistanceFromDepth(camera, depth));
    vec2 offset = vec2(patchCentre(texel, level) - patchCentre(parent, level + 1)) / float(2 << level);
    vec2 share = abs(offset);
    ivec2 side = ivec2(sign(offset));
    vec3 sum = vec3(0.0);
    float weights = 0.0;
#ifdef GLOSSY
    shape = shapeOfLobe(texelFetch(gbufferFinish, pixel, 0), kLeastVplRoughness);
    vec3 glossySum = vec3(0.0);
    float glossyWeights = 0.0;
#endif
    for (int i = 0; i < 4; ++i) {
      ivec2 step = ivec2(i & 1, i >> 1);
      vec2 linear = mix(1.0 - share, share, vec2(step));
      float weight = linear.x * linear.y;
      ivec2 q = parent + step * side;
      if (weight == 0.0 || any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, subCoarse))) continue;
      vec4 value = texelFetch(coarse, subset * subCoarse + q, 0);
      if (value.a > 0.0) {
        ivec2 there = patchSample(q, level + 1, grid, subset);
        weight *= max(alike(there), i == 0 ? 1e-3 : 0.0);
        sum += weight * value.rgb;
        weights += weight;
#ifdef GLOSSY
        weight *= max(likeLobe(there), i == 0 ? 1e-3 : 0.0);
        glossySum += weight * texelFetch(coarseGlossy, subset * subCoarse + q, 0).rgb;
        glossyWeights += weight;
#endif
        continue;
      }
#ifndef BILINEAR
      float parts = 0.0;
      for (int k = 0; k < 4; ++k)
        parts += texelFetch(atlas, origin + q * 2 + ivec2(k & 1, k >> 1), 0).a > 0.0 ? 1.0 : 0.0;
      for (int k = 0; k < 4; ++k) {
        ivec2 part = q * 2 + ivec2(k & 1, k >> 1);
        vec4 light = texelFetch(atlas, origin + part, 0);
        if (light.a == 0.0) continue;
        ivec2 there = patchSample(part, level, grid, subset);
        float portion = weight / parts * alike(there);
        sum += portion * light.rgb;
        weights += portion;
#ifdef GLOSSY
        portion *= likeLobe(there);
        glossySum += portion * texelFetch(atlasGlossy, origin + part, 0).rgb;
        glossyWeights += portion;
#endif
      }
#endif
    }
    outIrradiance = vec4(sum / weights, 1.0);
#ifdef GLOSSY
    outGlossy = vec4(glossySum / glossyWeights, 1.0);
#endif
  }
#ifdef FINAL
  vec3 towardsViewer = camera.lens.w > 0.0 ? camera.worldFromView[2].xyz
                                           : normalize(camera.worldFromView[3].xyz - position);
  float darkening = detail * max(dot(towardsViewer, normal), 0.0) + 1.0 - detail;
  outIrradiance.rgb *= darkening;
#ifdef GLOSSY
  outGlossy.rgb *= darkening;
#endif
#endif
}
