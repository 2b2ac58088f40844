#version 450
// Puts the 4×4 subsets back in their places (SUBSETS) and filters (FILTER): a cross-bilateral tent of 7×7, weights
// (1,2,3,4,3,2,1)², whole or along one axis at a time. Every subset gets the same total weight, so that a flat area shows
// the mean over all 16 subsets exactly; the more frames a pixel holds, the less its neighbours count. GLOSSY: glossy
// light too, with weights by roughness and metalness as well.
#include "lib/gbuffer.glsl"
#include "lib/light_outputs.glsl"
#include "lib/subsets.glsl"
#ifdef FILTER
#include "lib/surface_weight.glsl"
#endif

layout(binding = 2) uniform sampler2D irradiance;
#ifdef GLOSSY
layout(binding = 3) uniform sampler2D glossy; // radiance over glossyTint
#include "lib/lobe_shape.glsl"
layout(binding = 7) uniform sampler2D gbufferFinish;
#endif
uniform ivec2 reach;           // (3, 3) whole, (3, 0) along rows, (0, 3) along columns

vec4 irradianceAt(ivec2 pixel) { return texelFetch(irradiance, placeOf(pixel), 0); }

uniform bool fresh; // light of one frame
layout(binding = 5) uniform sampler2D worthOfMean; // HistoryPass::worth

const float kEnough = 16.0; // frames in a mean that needs no neighbours

/// What a neighbour counts for, by the frames in this pixel's mean.
float shareOf(float frames) { return fresh ? 1.0 : clamp((kEnough - frames) / (kEnough - 1.0), 0.0, 1.0); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  writeNoLight();
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
#ifdef FILTER
  PixelPlane plane = planeAt(pixel, depth);
  vec4 own = irradianceAt(pixel);
  float share = shareOf(fresh ? 1.0 : texelFetch(worthOfMean, pixel, 0).a);
#ifdef GLOSSY
  vec4 ownGlossy = texelFetch(glossy, placeOf(pixel), 0);
  float glossyShare = shareOf(ownGlossy.a);
  bool alone = share == 0.0 && glossyShare == 0.0;
#else
  bool alone = share == 0.0;
#endif
  ivec2 first = max(-reach, -pixel), last = min(reach, ivec2(camera.size.xy) - 1 - pixel);
  if (alone) first = last = ivec2(0);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
#ifdef GLOSSY
  vec4 shape = shapeOfLobe(texelFetch(gbufferFinish, pixel, 0), kLeastVplRoughness);
  vec3 glossySum = vec3(0.0);
  float glossyWeights = 0.0;
#endif
  for (int dy = first.y; dy <= last.y; ++dy) {
    for (int dx = first.x; dx <= last.x; ++dx) {
      ivec2 neighbour = pixel + ivec2(dx, dy);
      float neighbourDepth = texelFetch(gbufferDepth, neighbour, 0).r;
      if (neighbourDepth == 0.0) continue;
      float tent = float((4 - abs(dx)) * (4 - abs(dy)));
      float weight = tent * surfaceWeight(plane, ivec2(dx, dy), neighbour, neighbourDepth);
      bool other = dx != 0 || dy != 0;
      float counts = weight * (other ? share : 1.0);
      sum += counts * irradianceAt(neighbour).rgb;
      weights += counts;
#ifdef GLOSSY
      vec4 others = shapeOfLobe(texelFetch(gbufferFinish, neighbour, 0), kLeastVplRoughness);
      counts = weight * (other ? glossyShare : 1.0) * finishWeight(shape, others);
      glossySum += counts * texelFetch(glossy, placeOf(neighbour), 0).rgb;
      glossyWeights += counts;
#endif
    }
  }
  outIrradiance = vec4(weights > 0.0 ? sum / weights : own.rgb, own.a);
#ifdef GLOSSY
  outGlossy = vec4(glossyWeights > 0.0 ? glossySum / glossyWeights : ownGlossy.rgb, ownGlossy.a);
#endif
#else
  outIrradiance = irradianceAt(pixel);
#ifdef GLOSSY
  outGlossy = texelFetch(glossy, placeOf(pixel), 0);
#endif
#endif
}
