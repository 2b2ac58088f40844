#version 450
// Puts the 4×4 subsets back in their places (SUBSETS) and filters (FILTER): a cross-bilateral tent of 7×7, weights
// (1,2,3,4,3,2,1)², whole or along one axis at a time. Every subset gets the same total weight, so that a flat area shows
// the mean over all 16 subsets exactly; the more frames a pixel holds, the less its neighbours count. GLOSSY: glossy light too, with weights by roughness and metalness as well.
#include "lib/gbuffer.glsl"
#include "lib/light_outputs.glsl"
#include "lib/subsets.glsl"

layout(binding = 2) uniform sampler2D irradiance;
#ifdef GLOSSY
layout(binding = 3) uniform sampler2D glossy; // radiance over glossyTint
layout(binding = 7) uniform sampler2D gbufferRoughnessMetalness;
#endif
uniform ivec2 reach;           // (3, 3) whole, (3, 0) along rows, (0, 3) along columns
uniform float normalPower;
uniform float distanceSigma;   // share of the view distance

vec4 irradianceAt(ivec2 pixel) { return texelFetch(irradiance, placeOf(pixel), 0); }

uniform bool fresh; // light of one frame, whatever its a
uniform float full; // frames in a mean that needs no neighbours

/// What a neighbour counts for, by the frames in this pixel's mean.
float shareOf(float frames) { return fresh ? 1.0 : clamp((full - frames) / (full - 1.0), 0.0, 1.0); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  writeNoLight();
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
#ifdef FILTER
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 normalView = normal * mat3(camera.worldFromView); // transpose times: world to view
  // Height of a neighbour above this pixel's plane without rebuilding its position: the plane's equation is linear in
  // the pixel, times the neighbour's view distance for a perspective camera.
  bool orthographic = camera.lens.w > 0.0;
  vec2 ray = ((vec2(pixel) + 0.5) * camera.size.zw * 2.0 - 1.0) * camera.lens.xy;
  vec2 slope = 2.0 * camera.size.zw * camera.lens.xy * normalView.xy;
  float viewDistance = viewDistanceFromDepth(camera, depth);
  float base = dot(normalView.xy, ray) - (orthographic ? 0.0 : normalView.z);
  float plane = orthographic ? base - normalView.z * viewDistance : base * viewDistance;
  float inverseSigma = 1.0 / (distanceSigma * viewDistance);
  vec4 own = irradianceAt(pixel);
  float share = shareOf(own.a);
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
  vec2 roughnessMetalness = texelFetch(gbufferRoughnessMetalness, pixel, 0).rg;
  vec3 glossySum = vec3(0.0);
  float glossyWeights = 0.0;
#endif
  for (int dy = first.y; dy <= last.y; ++dy) {
    for (int dx = first.x; dx <= last.x; ++dx) {
      ivec2 neighbour = pixel + ivec2(dx, dy);
      float neighbourDepth = texelFetch(gbufferDepth, neighbour, 0).r;
      if (neighbourDepth == 0.0) continue;
      float distance = viewDistanceFromDepth(camera, neighbourDepth);
      float line = base + dot(slope, vec2(dx, dy));
      float height = ((orthographic ? line - normalView.z * distance : line * distance) - plane) * inverseSigma;
      float alignment = max(dot(normal, texelFetch(gbufferNormal, neighbour, 0).xyz), 1e-4);
      // alignment^power · exp(-h²/2), with one exponential
      float weight = float((4 - abs(dx)) * (4 - abs(dy))) *
                     exp2(normalPower * log2(alignment) - 0.7213475 * height * height);
      bool other = dx != 0 || dy != 0;
      float counts = weight * (other ? share : 1.0);
      sum += counts * irradianceAt(neighbour).rgb;
      weights += counts;
#ifdef GLOSSY
      // Lobes of other shape hold other light: exp(-Δ²/2σ²), σ = 0.1 of roughness or metalness.
      vec2 difference = texelFetch(gbufferRoughnessMetalness, neighbour, 0).rg - roughnessMetalness;
      counts = weight * (other ? glossyShare : 1.0) * exp2(-72.13475 * dot(difference, difference));
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
