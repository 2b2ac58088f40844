#version 450
// Noise of means over frames, averaged over neighbours whose surface is alike and whose light is, within its noise
// (Schied et al., "Spatiotemporal variance-guided filtering", 2017). BEGIN: the variance of the means, from how far a
// pixel's frames lie apart; of few frames, from how far its neighbours do. Else one step of an à-trous wavelet
// filter, 3×3 taps. GLOSSY: glossy light too, with weights by its own noise, by roughness and by metalness.
#include "lib/gbuffer.glsl"
#include "lib/light_outputs.glsl" // alpha: variance of the luminance
#include "lib/variance.glsl"
#include "lib/surface_weight.glsl"

layout(binding = 2) uniform sampler2D irradiance; // alpha: BEGIN frames in the variance, else variance
#ifdef GLOSSY
layout(binding = 3) uniform sampler2D glossy; // alpha: BEGIN frames in the mean, else variance
#include "lib/lobe_shape.glsl"
layout(binding = 7) uniform sampler2D gbufferFinish;
#endif
#ifdef BEGIN
layout(binding = 4) uniform sampler2D frameVariance; // HistoryPass::variance
layout(binding = 5) uniform sampler2D worthOfMean; // HistoryPass::worth
#endif
const int kReach = 1; // taps
uniform int stride; // pixels between taps

const float kAlike = 2.0; // standard deviations by which light may differ

/// One kind of light on its way through the taps.
struct Sum {
  vec4 own;
  vec3 light; // BEGIN: variance of a frame, luminance, its square
  float weights, squares; // of variance, weights squared
};

Sum begin(vec4 own) { return Sum(own, vec3(0.0), 0.0, 0.0); }

void add(inout Sum sum, vec4 tap, float variance, float weight) {
  float brightness = dot(kLuminance, tap.rgb);
  if (isnan(brightness) || isinf(brightness)) return;
#ifdef BEGIN
  sum.light += weight * vec3(variance, brightness, brightness * brightness);
  sum.weights += weight;
#else
  float apart = brightness - dot(kLuminance, sum.own.rgb);
  // Of both, so that what a pixel gives away its neighbour takes: by its own variance alone, outliers lose light.
  float deviation = sqrt(sqrt(sum.own.a) * sqrt(tap.a));
  weight *= exp(-abs(apart) / (kAlike * deviation + 1e-6 * abs(brightness) + 1e-30));
  sum.light += weight * tap.rgb;
  sum.weights += weight;
  sum.squares += weight * weight * tap.a;
#endif
}

#ifdef BEGIN
/// The variance of a mean that is worth some frames, by that of a frame, which is known from `frames`.
vec4 meanOf(Sum sum, float frames, float worth) {
  if (!(sum.weights > 0.0)) return vec4(sum.own.rgb, 0.0);
  vec3 mean = sum.light / sum.weights;
  float ofFrames = mean.x / max(worth, 1.0), ofNeighbours = max(mean.z - mean.y * mean.y, 0.0);
  return vec4(sum.own.rgb, mix(ofNeighbours, ofFrames, clamp((frames - 1.0) / 4.0, 0.0, 1.0)));
}
#else
vec4 meanOf(Sum sum) {
  if (!(sum.weights > 0.0)) return vec4(sum.own.rgb, 0.0);
  return vec4(sum.light / sum.weights, sum.squares / (sum.weights * sum.weights));
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  writeNoLight();
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  PixelPlane plane = planeAt(pixel, depth);
  Sum diffuse = begin(texelFetch(irradiance, pixel, 0));
#ifdef GLOSSY
  Sum lobe = begin(texelFetch(glossy, pixel, 0));
  vec4 shape = shapeOfLobe(texelFetch(gbufferFinish, pixel, 0), kLeastRoughness);
#endif
#ifndef BEGIN
  float noise = diffuse.own.a;
#ifdef GLOSSY
  noise += lobe.own.a;
#endif
  if (noise == 0.0) { // no neighbour would count
    outIrradiance = diffuse.own;
#ifdef GLOSSY
    outGlossy = lobe.own;
#endif
    return;
  }
#endif
  ivec2 size = ivec2(camera.size.xy);
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      ivec2 offset = stride * ivec2(dx, dy), tap = pixel + offset;
      if (any(lessThan(tap, ivec2(0))) || any(greaterThanEqual(tap, size))) continue;
      float tapDepth = texelFetch(gbufferDepth, tap, 0).r;
      if (tapDepth == 0.0) continue;
      float weight = float((kReach + 1 - abs(dx)) * (kReach + 1 - abs(dy)));
      if (offset != ivec2(0)) weight *= surfaceWeight(plane, offset, tap, tapDepth);
#ifdef BEGIN
      vec2 variance = texelFetch(frameVariance, tap, 0).rg;
#else
      vec2 variance = vec2(0.0);
#endif
      add(diffuse, texelFetch(irradiance, tap, 0), variance.r, weight);
#ifdef GLOSSY
      weight *= finishWeight(shape, shapeOfLobe(texelFetch(gbufferFinish, tap, 0), kLeastRoughness));
      add(lobe, texelFetch(glossy, tap, 0), variance.g, weight);
#endif
    }
  }
#ifdef BEGIN
  float known = diffuse.own.a; // frames in the variance
  outIrradiance = meanOf(diffuse, known, texelFetch(worthOfMean, pixel, 0).a);
#else
  outIrradiance = meanOf(diffuse);
#endif
#ifdef GLOSSY
#ifdef BEGIN
  outGlossy = meanOf(lobe, known, lobe.own.a);
#else
  outGlossy = meanOf(lobe);
#endif
#endif
}
