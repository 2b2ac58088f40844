#version 450
// Mean of the light that fell on the place of a pixel, in this picture and those before it. The place is looked up where
// the camera before saw it; of the four pixels around, those count that saw the same surface. Variants: SUBSETS (light of
// this picture is de-interleaved), CHANGES (light changes: what is kept is held to the range of `fresh` around the pixel),
// GLOSSY.
#include "lib/gbuffer.glsl"
#include "shared/octahedral.h"

layout(std140, binding = 2) uniform Before { CameraBlock before; };
layout(binding = 2) uniform sampler2D irradiance; // of this picture
layout(binding = 3) uniform sampler2D keptIrradiance;
layout(binding = 4) uniform sampler2D keptSeen; // octahedral normal, view distance, pictures in the mean (0: nothing)
#ifdef CHANGES
layout(binding = 9) uniform sampler2D fresh; // this picture's light, filtered
#endif
#ifdef GLOSSY
layout(binding = 5) uniform sampler2D glossy;
layout(binding = 8) uniform sampler2D keptGlossy; // a: pictures in its mean
uniform float glossyPictures; // as `pictures`
layout(location = 2) out vec4 outGlossy;
#endif
uniform ivec2 tileSize; // of a sub-image
uniform float pictures; // of those before that count at most; 0: there are none
layout(location = 0) out vec4 outIrradiance; // a: pictures in the mean
layout(location = 1) out vec4 outSeen;

const float kOnPlane = 0.01; // deviation from the pixel's plane, share of the view distance
const float kAlike = 0.9;    // cosine between normals

ivec2 placeOf(ivec2 pixel) {
#ifdef SUBSETS
  return (pixel & 3) * tileSize + (pixel >> 2);
#else
  return pixel;
#endif
}

/// Position that a pixel of the picture before saw.
vec3 positionBefore(ivec2 pixel, float viewDistance) {
  vec2 ndc = (vec2(pixel) + 0.5) * before.size.zw * 2.0 - 1.0;
  vec2 xy = ndc * before.lens.xy * (before.lens.w > 0.0 ? 1.0 : viewDistance);
  return (before.worldFromView * vec4(xy, -viewDistance, 1.0)).xyz;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = outSeen = vec4(0.0);
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 position = positionFromDepth(pixel, depth);
  vec4 kept = vec4(0.0);
  float weights = 0.0;
#ifdef GLOSSY
  vec4 keptLobe = vec4(0.0);
#endif
  vec4 clip = before.clipFromWorld * vec4(position, 1.0);
  vec2 at = (clip.xy / clip.w * 0.5 + 0.5) * before.size.xy - 0.5;
  if (pictures > 0.0 && clip.w > 0.0 && all(greaterThan(at, vec2(-1.0))) && all(lessThan(at, before.size.xy))) {
    vec2 corner = floor(at + 1e-3); // a camera that stands meets centres, but for rounding
    vec2 inside = max(at - corner, 0.0);
    for (int i = 0; i < 4; ++i) {
      ivec2 step = ivec2(i & 1, i >> 1), tap = ivec2(corner) + step;
      vec2 near = mix(1.0 - inside, inside, vec2(step));
      float weight = near.x * near.y;
      if (weight < 2e-3 || any(lessThan(tap, ivec2(0))) || any(greaterThanEqual(tap, ivec2(before.size.xy)))) continue;
      vec4 seen = texelFetch(keptSeen, tap, 0);
      if (seen.a == 0.0 || dot(normal, unitFromOctahedral(seen.xy)) < kAlike) continue;
      if (abs(dot(normal, positionBefore(tap, seen.z) - position)) > kOnPlane * seen.z) continue;
      kept += weight * texelFetch(keptIrradiance, tap, 0);
      weights += weight;
#ifdef GLOSSY
      keptLobe += weight * texelFetch(keptGlossy, tap, 0);
#endif
    }
  }
  if (weights > 0.0) kept /= weights;
  kept.a = min(kept.a, pictures);
#ifdef CHANGES
  vec3 least = vec3(3.4e38), most = vec3(0.0);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      ivec2 other = clamp(pixel + ivec2(dx, dy), ivec2(0), ivec2(camera.size.xy) - 1);
      if (texelFetch(gbufferDepth, other, 0).r == 0.0) continue;
      vec3 light = texelFetch(fresh, other, 0).rgb;
      least = min(least, light);
      most = max(most, light);
    }
  kept.rgb = clamp(kept.rgb, least, most);
#endif
  outIrradiance = vec4(mix(kept.rgb, texelFetch(irradiance, placeOf(pixel), 0).rgb, 1.0 / (kept.a + 1.0)), kept.a + 1.0);
  outSeen = vec4(octahedralFromUnit(normal), viewDistanceFromDepth(camera, depth), kept.a + 1.0);
#ifdef GLOSSY
  if (weights > 0.0) keptLobe /= weights;
  keptLobe.a = min(keptLobe.a, glossyPictures);
  outGlossy = vec4(mix(keptLobe.rgb, texelFetch(glossy, placeOf(pixel), 0).rgb, 1.0 / (keptLobe.a + 1.0)), keptLobe.a + 1.0);
#endif
}
