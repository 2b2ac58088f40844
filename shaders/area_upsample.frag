#version 450
// The share of area lights' light that reaches each pixel, from that of fragments of all sizes, in one pass (paper 4,
// section 3.1.5): those of at most 4 × 4 pixels are copied; within larger ones three Gaussian radial basis functions, as wide
// as the fragment and around the samples nearest to the pixel, are fitted to what these hold. Beyond the paper: only samples
// of the same surface; where the fit is ill-conditioned, the mean by weights; never beyond the samples' range, so that a
// constant stays one. Variants:
// none copies, MARK keeps the pixels that lie between samples that differ (for the stencil), BETWEEN interpolates there.
#include "lib/gbuffer.glsl"
#include "shared/patches.h"

layout(binding = 2) uniform sampler2D atlas; // a: 0 no fragment; of large ones 2: others around hold something else
uniform ivec2 base;          // of the atlas's level 0
uniform int coarsest;        // level
uniform float normalPower;   // as in upsample.frag
uniform float distanceSigma;
uniform int stable; // what is seen between the middles of a fragment's quarters: 0 unknown; 1 the same where that is all
                    // or nothing; 2 the same
layout(location = 0) out vec4 outShare;

/// Level of the fragment that a pixel belongs to; −1: none. From the coarsest on, where most are.
int levelAt(ivec2 pixel) {
  int found = texelFetch(atlas, pixel, 0).a > 0.0 ? 0 : -1;
  for (int level = coarsest; level > 0 && found < 0; --level)
    if (texelFetch(atlas, atlasOrigin(base, level) + (pixel >> level), 0).a > 0.0) found = level;
  return found;
}

#ifdef BETWEEN
const float kVariance = 2.0;           // C of equation 2b
const float kLeastDeterminant = 1e-5; // of the fit's matrix, whose diagonal is 1

struct Sample {
  vec2 at; // pixels
  vec3 share;
  float distance2; // to the pixel
};
Sample nearest[3];
int found = 0;
vec3 position, normal;
vec2 here;
float inverseSigma;
float inverseWidth; // of the fragment

bool sameSurface(ivec2 pixel) {
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return false;
  float height = dot(normal, positionFromDepth(pixel, depth) - position) * inverseSigma;
  float alignment = max(dot(normal, texelFetch(gbufferNormal, pixel, 0).xyz), 1e-4);
  return exp2(normalPower * log2(alignment) - 0.7213475 * height * height) > 0.25;
}

void keep(Sample s) {
  for (int i = 0; i < found; ++i)
    if (nearest[i].at == s.at) return;
  for (int i = 0; i < 3; ++i) {
    if (i < found && nearest[i].distance2 <= s.distance2) continue;
    Sample next = nearest[i];
    nearest[i] = s;
    s = next;
    if (i >= found) break;
  }
  found = min(found + 1, 3);
}

Sample nearestHere; // of one fragment

void consider(ivec2 texel, int level, bool each) {
  ivec2 pixel = patchPixel(texel, level, 1, ivec2(0), ivec2(camera.size.xy));
  if (!sameSurface(pixel)) return;
  float width = float(1 << level);
  vec2 middle = vec2(texel) * width + 0.5 * (width - 1.0);
  vec3 share = texelFetch(atlas, atlasOrigin(base, level) + texel, 0).rgb;
  // Quarters that see the same: so does all between their middles (the paper's stable region, figure 3a).
  bool known = stable == 2 || (stable == 1 && (share == vec3(0.0) || share == vec3(1.0)));
  vec2 at = known && level >= 3 ? clamp(here, middle - 0.25 * width, middle + 0.25 * width) : middle, way = at - here;
  // In half shadow a fragment knows but a quarter of the places on a lamp that a single pixel knows: three of these within
  // its width count before it.
  bool partly = any(greaterThan(share, vec3(0.0))) && any(lessThan(share, vec3(1.0)));
  float coarse = stable == 2 && level >= 3 && partly ? width * width : 0.0;
  Sample s = Sample(at, share, dot(way, way) + coarse);
  if (each)
    keep(s);
  else if (s.distance2 < nearestHere.distance2)
    nearestHere = s;
}

/// The fragment around a pixel, and where it is large its single pixels (area_fragments.cpp): each of them, or the nearest
/// alone, as many on one side say little of what lies between sides.
void considerAround(ivec2 pixel, bool each) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return;
  int level = levelAt(pixel);
  if (level < 0) return;
  nearestHere = Sample(vec2(0.0), vec3(0.0), 1e30);
  consider(pixel >> level, level, each);
  int coarse = level;
  if (level == 0) { // maybe one of those
    for (coarse = 3; coarse <= coarsest; ++coarse)
      if (texelFetch(atlas, atlasOrigin(base, coarse) + (pixel >> coarse), 0).a > 0.0) break;
    if (coarse <= coarsest) consider(pixel >> coarse, coarse, each);
  }
  if (coarse >= 3 && coarse <= coarsest) {
    int side = 1 << coarse;
    ivec2 origin = (pixel >> coarse) * side;
    ivec2 within[3] = ivec2[3](ivec2(side / 2, side - 1), ivec2(0, side - 1), ivec2(0, side / 2));
    for (int i = 0; i < 3; ++i) {
      ivec2 single = origin + within[i];
      if (all(lessThan(single, ivec2(camera.size.xy))) && texelFetch(atlas, single, 0).a > 0.0) consider(single, 0, each);
    }
  }
  if (nearestHere.distance2 < 1e30) keep(nearestHere);
}

float basis(vec2 at, Sample s) {
  vec2 way = (at - s.at) * inverseWidth;
  return exp(-dot(way, way) / kVariance);
}

vec3 interpolated(ivec2 pixel, int level, float depth, vec3 own) {
  here = vec2(pixel);
  position = positionFromDepth(pixel, depth);
  normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  inverseSigma = 1.0 / max(distanceSigma * viewDistanceFromDepth(camera, depth), 1e-20);
  int side = 1 << level;
  inverseWidth = 1.0 / float(side);
  ivec2 lo = (pixel >> level) * side, hi = lo + side;
  considerAround(pixel, true);
  considerAround(ivec2(lo.x - 1, pixel.y), false);
  considerAround(ivec2(hi.x, pixel.y), false);
  considerAround(ivec2(pixel.x, lo.y - 1), false);
  considerAround(ivec2(pixel.x, hi.y), false);
  if (found == 0) return own;

  vec3 weights = vec3(0.0), least = nearest[0].share, most = least;
  for (int i = 0; i < found; ++i) {
    weights[i] = basis(here, nearest[i]);
    least = min(least, nearest[i].share);
    most = max(most, nearest[i].share);
  }
  float sum = weights.x + weights.y + weights.z;
  vec3 share = nearest[0].share;
  if (sum > 1e-6) {
    share = vec3(0.0);
    for (int i = 0; i < found; ++i) share += weights[i] / sum * nearest[i].share;
  }
  if (found == 3) {
    mat3 m; // column j: basis j at the samples
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) m[j][i] = basis(nearest[i].at, nearest[j]);
    if (abs(determinant(m)) > kLeastDeterminant) {
      vec3 w = weights * inverse(m); // Φ(x)ᵀ Φ⁻¹, of what the samples have beyond the mean
      share += w.x * (nearest[0].share - share) + w.y * (nearest[1].share - share) + w.z * (nearest[2].share - share);
    }
  }
  return clamp(share, least, most);
}

#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outShare = vec4(0.0);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  int level = depth == 0.0 ? -1 : levelAt(pixel);
  vec4 own = level < 0 ? vec4(0.0) : texelFetch(atlas, atlasOrigin(base, level) + (pixel >> level), 0);
#ifdef MARK
  if (own.a < 1.5) discard;
#elif defined(BETWEEN)
  outShare = vec4(interpolated(pixel, level, depth, own.rgb), 1.0);
#else
  outShare = own;
#endif
}
