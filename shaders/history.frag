#version 450
// Mean of the light that fell on the place of a pixel, in this frame and those before it. The place is looked up where
// the camera before saw it; of the four pixels around, those count that saw the same surface. Variants: SUBSETS (this
// frame's light is de-interleaved), CHANGES (what is kept, and this frame's difference to it, for
// history_follow.frag), GLOSSY.
#include "lib/gbuffer.glsl"
#include "lib/subsets.glsl"
#include "lib/variance.glsl"
#include "shared/octahedral.h"

layout(std140, binding = 2) uniform Before { CameraBlock before; };
layout(binding = 2) uniform sampler2D irradiance; // of this frame
layout(binding = 3) uniform sampler2D keptIrradiance;
layout(binding = 4) uniform sampler2D keptSeen; // octahedral normal, view distance, frames that the mean is worth, or 0
uniform float mostFrames; // of those before that count at most; 0: there are none
uniform float mostKnown; // earlier frames in a variance; 0: they had other noise
uniform float cycleFrames; // as HistoryInputs::cycleFrames
uniform bool stands;    // the camera is where it was
uniform bool smoothed;  // what was shown before had little noise: its edges say how much looking up blurs
layout(location = 0) out vec4 outIrradiance; // a: frames in the variance
#ifdef CHANGES
layout(location = 1) out vec4 outChange;
#else
layout(location = 1) out vec4 outSeen;
#endif
#ifdef GLOSSY
layout(binding = 5) uniform sampler2D glossy;
layout(binding = 8) uniform sampler2D keptGlossy; // a: frames in its mean
layout(binding = 7) uniform sampler2D gbufferFinish;
uniform float mostGlossyFrames; // as `mostFrames`
layout(location = 2) out vec4 outGlossy;
#endif
layout(binding = 9) uniform sampler2D keptVariance;
layout(binding = 10) uniform sampler2D smoothIrradiance; // what is kept, without most of its noise
#ifdef GLOSSY
layout(binding = 11) uniform sampler2D smoothGlossy;
#endif
layout(location = 3) out vec2 outVariance; // of irradiance, of glossy light

const float kOnPlane = 0.4;  // deviation from the pixel's plane, pixels
const float kAlike = 0.9;    // cosine between normals: a moulding's faces see other lights
const float kSmears = 0.35;  // roughness from which on glossy light in motion is of as many frames as may be
const float kMoving = 16.0;  // frames in the mean of a place that moves over the pixels: looking up blurs a little

/// Position that a pixel of the frame before saw.
vec3 positionBefore(ivec2 pixel, float viewDistance) {
  vec2 ndc = (vec2(pixel) + 0.5) * before.size.zw * 2.0 - 1.0;
  vec2 xy = ndc * before.lens.xy * (before.lens.w > 0.0 ? 1.0 : viewDistance);
  return (before.worldFromView * vec4(xy, -viewDistance, 1.0)).xyz;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = vec4(0.0);
#ifdef CHANGES
  outChange = vec4(0.0);
#else
  outSeen = vec4(0.0);
#endif
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
  outVariance = vec2(0.0);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 position = positionFromDepth(pixel, depth);
  vec4 kept = vec4(0.0);
  float weights = 0.0;
#ifdef GLOSSY
  vec4 keptLobe = vec4(0.0);
#endif
  float known = 0.0; // frames in the variance
  vec2 variance = vec2(0.0), least = vec2(1e38);
  vec2 span = vec2(1e38, 0.0), lobeSpan = span; // of what was looked up, luminance
  vec4 clip = before.clipFromWorld * vec4(position, 1.0);
  vec2 at = stands ? vec2(pixel) : (clip.xy / clip.w * 0.5 + 0.5) * before.size.xy - 0.5;
  if (mostFrames > 0.0 && clip.w > 0.0 && all(greaterThan(at, vec2(-1.0))) && all(lessThan(at, before.size.xy))) {
    float metresPerPixel = 2.0 * before.lens.y * before.size.w * (before.lens.w > 0.0 ? 1.0 : clip.w);
    vec2 corner = floor(at), inside = at - corner;
    for (int i = 0; i < 4; ++i) {
      ivec2 step = ivec2(i & 1, i >> 1), tap = ivec2(corner) + step;
      vec2 near = mix(1.0 - inside, inside, vec2(step));
      float weight = near.x * near.y;
      if (weight == 0.0 || any(lessThan(tap, ivec2(0))) || any(greaterThanEqual(tap, ivec2(before.size.xy)))) continue;
      vec4 seen = texelFetch(keptSeen, tap, 0);
      if (seen.a == 0.0 || dot(normal, unitFromOctahedral(seen.xy)) < kAlike) continue;
      if (abs(dot(normal, positionBefore(tap, seen.z) - position)) > kOnPlane * metresPerPixel) continue;
      vec4 light = texelFetch(keptIrradiance, tap, 0);
      kept += weight * vec4(light.rgb, seen.a);
      weights += weight;
#ifdef GLOSSY
      vec4 lobe = texelFetch(keptGlossy, tap, 0);
      keptLobe += weight * lobe;
#endif
      known += weight * light.a;
      vec2 tapVariance = texelFetch(keptVariance, tap, 0).rg;
      variance += weight * tapVariance;
      if (light.a > 1.5 && mostKnown > 0.0) least = min(least, tapVariance); // one frame has no variance yet
      span = spanWith(span, texelFetch(smoothIrradiance, tap, 0).rgb);
#ifdef GLOSSY
      lobeSpan = spanWith(lobeSpan, texelFetch(smoothGlossy, tap, 0).rgb);
#endif
    }
  }
  vec3 now = texelFetch(irradiance, placeOf(pixel), 0).rgb;
  // Where some of the four saw another surface, the others stand beside the place: they count as fewer frames.
  kept = weights > 0.0 ? vec4(kept.rgb / weights, kept.a) : vec4(now, 0.0);
  if (any(isnan(kept)) || any(isinf(kept))) kept = vec4(now, 0.0); // of one frame, not of all that follow
  if (cycleFrames > 0.0) kept.a *= min(kept.a / cycleFrames, 1.0); // by all that it holds, before it is cut to few
  // Of a smaller frame a pixel is a blur of several of ours: it counts as fewer.
  float finer = min(before.size.x / camera.size.x, 1.0);
  kept.a = min(kept.a, stands ? mostFrames : min(mostFrames, (kMoving - 1.0) * finer * finer));
  if (weights > 0.0) variance /= weights, known = min(known / weights, mostKnown);
  if (any(isnan(variance)) || any(isinf(variance))) variance = vec2(0.0);
  outVariance.r = varianceWith(variance.r, dot(kLuminance, now), span, known);
  bool blurs = smoothed && !stands;
  float counts = min(kept.a, blurs ? framesWorth(least.r, span) : kept.a);
#ifdef CHANGES
  outIrradiance = vec4(kept.rgb, counts);
  bool isNumber = !any(isnan(now)) && !any(isinf(now));
  outChange = vec4(isNumber ? now - kept.rgb : vec3(0.0), known + 1.0);
#else
  outIrradiance = vec4(mix(kept.rgb, now, 1.0 / (counts + 1.0)), known + 1.0);
  outSeen = vec4(octahedralFromUnit(normal), viewDistanceFromDepth(camera, depth), counts + 1.0);
#endif
#ifdef GLOSSY
  if (weights > 0.0) keptLobe /= weights;
  if (any(isnan(keptLobe)) || any(isinf(keptLobe))) keptLobe = vec4(0.0);
  if (cycleFrames > 0.0) keptLobe.a *= min(keptLobe.a / cycleFrames, 1.0);
  // What a sharp lobe shows does not move with its surface: the sharper, the fewer frames hold it. Its rays have the
  // less noise.
  float sharp = min(texelFetch(gbufferFinish, pixel, 0).r / kSmears, 1.0);
  keptLobe.a = min(keptLobe.a, stands ? mostGlossyFrames : mostGlossyFrames * sharp * sharp);
  vec3 lobe = texelFetch(glossy, placeOf(pixel), 0).rgb;
  float lobeCounts = keptLobe.a;
  outVariance.g = varianceWith(variance.g, dot(kLuminance, lobe), lobeSpan, known);
  if (blurs) lobeCounts = min(lobeCounts, framesWorth(least.g, lobeSpan));
  vec3 mean = lobeCounts > 0.0 ? mix(keptLobe.rgb, lobe, 1.0 / (lobeCounts + 1.0)) : lobe;
  outGlossy = vec4(mean, lobeCounts + 1.0);
#endif
}
