#version 450
// Puts the 4×4 subsets back in their places. With FILTER: cross-bilateral 7×7 with tent weights (1,2,3,4,3,2,1)², in
// which every subset has the same total weight, so that a flat area shows the mean over all 16 subsets exactly.
#include "lib/gbuffer.glsl"

layout(binding = 2) uniform sampler2D irradiance;
uniform ivec2 tileSize;        // of a sub-image
uniform float normalPower;
uniform float distanceSigma;   // share of the view distance
layout(location = 0) out vec4 outIrradiance;

vec3 irradianceAt(ivec2 pixel) {
  return texelFetch(irradiance, (pixel & 3) * tileSize + (pixel >> 2), 0).rgb;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = vec4(0.0);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
#ifdef FILTER
  vec3 positionView = positionViewFromDepth(camera, vec2(pixel) + 0.5, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 normalView = normal * mat3(camera.worldFromView); // transpose times: world to view
  float inverseSigma = 1.0 / (distanceSigma * -positionView.z);
  ivec2 size = ivec2(camera.size.xy);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int dy = -3; dy <= 3; ++dy) {
    for (int dx = -3; dx <= 3; ++dx) {
      ivec2 neighbour = pixel + ivec2(dx, dy);
      if (any(lessThan(neighbour, ivec2(0))) || any(greaterThanEqual(neighbour, size))) continue;
      float neighbourDepth = texelFetch(gbufferDepth, neighbour, 0).r;
      if (neighbourDepth == 0.0) continue;
      vec3 neighbourView = positionViewFromDepth(camera, vec2(neighbour) + 0.5, neighbourDepth);
      float planeDistance = dot(normalView, neighbourView - positionView) * inverseSigma;
      float alignment = max(dot(normal, texelFetch(gbufferNormal, neighbour, 0).xyz), 1e-4);
      // alignment^power · exp(-d²/2), with one exponential
      float weight = float((4 - abs(dx)) * (4 - abs(dy))) *
                     exp2(normalPower * log2(alignment) - 0.7213475 * planeDistance * planeDistance);
      sum += weight * irradianceAt(neighbour);
      weights += weight;
    }
  }
  outIrradiance = vec4(weights > 0.0 ? sum / weights : irradianceAt(pixel), 1.0);
#else
  outIrradiance = vec4(irradianceAt(pixel), 1.0);
#endif
}
