#version 450
// One buffer as a display shows it. MODE 0: radiance (exposure, tone mapper, sRGB, dither); 1: colour in [0,1]
// (sRGB); 2: unit vector; 3: depth. MODE 0 variants: REFLECTED (source is irradiance: times albedo/π), EMITTED (plus emission,
// and the sky as background), DEINTERLEAVED (source lies in 4×4 tiles), GREY, PATCHES (tinted by the size of the patch that
// gathered, with its outline), FRAGMENTS (by that of the fragment that asked lamps), GLOSSY (REFLECTED: with the receivers'
// lobes), DAYLIGHT (EMITTED: of the sky), LUMA (alpha: see antialias.frag), ERROR (how far the value is from a truth, mean
// of the channels).
#include "shared/error_color.h"
#include "shared/tone_map.h"
#include "lib/background.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
layout(binding = 8) uniform sampler2D glossy; // radiance over glossyTint
#endif
layout(binding = 2) uniform sampler2D source;
layout(binding = 3) uniform sampler2D albedo;
layout(binding = 4) uniform sampler2D emission;
uniform float factor;     // exposure (mode 0); metres shown as mid grey (mode 3)
uniform vec2 lens;        // near, far (0: perspective), metres (mode 3)
uniform ivec2 tileSize;   // DEINTERLEAVED
uniform int toneMapper;
uniform int markNan;
layout(location = 0) out vec4 outColor;

#if defined(PATCHES) || defined(FRAGMENTS)
layout(binding = 5) uniform sampler2D patchNormals; // PatchPyramid::normalLo; FRAGMENTS: SurfaceLighting::fragments
uniform int patchLevels;
uniform int finestPatch; // level
#endif

#ifdef ERROR
layout(binding = 12) uniform sampler2D truth; // as the source, with all that the variants make of it
uniform float fullError;
#endif

#ifdef LUMA
const float kMark = 0.0;
#else
const float kMark = 1.0;
#endif
const float kInversePi = 0.318309886;

vec3 srgbFromLinear(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

/// In [0, 1), spread evenly over any few neighbours (interleaved gradient noise, Jimenez 2014): what 8 bits cannot hold
/// is right in the mean, without bands. Values that they hold stay as they are.
float ditherAt(ivec2 pixel) { return fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715)))); }

vec3 sourceAt(ivec2 pixel) {
#ifdef DEINTERLEAVED
  return texelFetch(source, (pixel & 3) * tileSize + (pixel >> 2), 0).rgb;
#else
  return texelFetch(source, min(pixel, textureSize(source, 0) - 1), 0).rgb; // one texel stands for a constant
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  vec3 value = sourceAt(pixel);
#if MODE == 0
#ifdef GLOSSY
  if (depth > 0.0)
    value = reflectedAt(pixel, depth, value, texelFetch(glossy, min(pixel, textureSize(glossy, 0) - 1), 0).rgb);
#elif defined(REFLECTED)
  value *= texelFetch(albedo, pixel, 0).rgb * kInversePi;
#endif
#ifdef EMITTED
  value = depth == 0.0 ? backgroundAt(pixel) : value + texelFetch(emission, pixel, 0).rgb;
#endif
  if (markNan != 0 && any(isnan(value))) {
    outColor = vec4(1.0, 0.0, 1.0, kMark);
    return;
  }
  if (markNan != 0 && any(isinf(value))) {
    outColor = vec4(0.0, 1.0, 1.0, kMark);
    return;
  }
#ifdef ERROR
  outColor = vec4(errorColor(dot(value - texelFetch(truth, pixel, 0).rgb, vec3(1.0 / 3.0)) / fullError), 1.0);
  return;
#endif
  value = max(value * factor, 0.0);
  value = toneMapped(value, toneMapper);
#if defined(PATCHES) || defined(FRAGMENTS)
#ifdef PATCHES
  int level = finestPatch;
  for (int i = finestPatch + 1; i <= patchLevels; ++i)
    if (texelFetch(patchNormals, pixel >> i, i - 1).a < 0.5) level = i;
#else
  int level = int(255.0 * texelFetch(patchNormals, pixel, 0).r + 0.5) - 1;
#endif
  float coarse = float(level - finestPatch) / float(max(1, patchLevels - finestPatch));
  vec3 tint = mix(mix(vec3(1.0, 0.1, 0.1), vec3(0.2, 1.0, 0.2), min(2.0 * coarse, 1.0)), vec3(0.2, 0.3, 1.0),
                  max(2.0 * coarse - 1.0, 0.0));
  bool outline = level > finestPatch && any(equal(pixel & ((1 << level) - 1), ivec2(0)));
  if (depth > 0.0 && level >= 0) value = outline ? tint * 0.7 : mix(value, tint, 0.25);
#endif
#ifdef GREY
  value = vec3(dot(value, vec3(0.2126, 0.7152, 0.0722)));
#endif
  value = srgbFromLinear(value);
#ifdef LUMA
  outColor.a = max(dot(value, vec3(0.2126, 0.7152, 0.0722)), 1.0 / 255.0);
#else
  outColor.a = 1.0;
#endif
  outColor.rgb = value + (ditherAt(pixel) - 0.5) / 255.0;
#else
  outColor = vec4(0.0, 0.0, 0.0, 1.0);
  if (depth == 0.0) return;
#if MODE == 1
  outColor.rgb = srgbFromLinear(value);
#elif MODE == 2
  outColor.rgb = value * 0.5 + 0.5;
#else
  float distance = lens.y > 0.0 ? lens.y - depth * (lens.y - lens.x) : lens.x / depth;
  outColor.rgb = vec3(factor / (factor + distance));
#endif
#endif
}
