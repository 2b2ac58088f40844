#version 450
// Irradiance from the trees over reflective shadow maps, each fragment with clusters of its own choice (hierarchical
// image-space radiosity, paper 3, section 3.5). The tree of a map is walked in Morton order without a stack: below a
// cluster that is refined come its four parts, after one that is taken the next of its size or larger. A draw may begin and
// end within a tree: what is taken belongs to the draw in which it begins.
// Variants PATCHES and GLOSSY as in gather.frag.
#include "lib/gbuffer.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#endif
#include "lib/gathered_pixel.glsl"
#include "lib/light_outputs.glsl"

layout(binding = 2) uniform sampler2D positions; // see ReflectiveMaps
layout(binding = 3) uniform sampler2D normals;
layout(binding = 4) uniform sampler2D fluxes;
uniform ivec2 origin;    // of the map, texels
uniform float threshold; // see tree_gather.cpp
uniform int coarsest; // mip levels
uniform int finest;
uniform int firstRoot; // of the map's coarsest clusters this draw starts from
uniform int endRoot;
uniform int rootStep;
uniform int firstLeaf; // of each tree, finest clusters
uniform int endLeaf;
uniform float diskFactor;
uniform float largestG;
uniform float spread; // GLOSSY
uniform float mirrors; // GLOSSY

/// Every second bit of m, as a number.
int evenBits(int m) {
  m &= 0x55555555;
  m = (m | (m >> 1)) & 0x33333333;
  m = (m | (m >> 2)) & 0x0f0f0f0f;
  m = (m | (m >> 4)) & 0x00ff00ff;
  return (m | (m >> 8)) & 0xffff;
}

void main() {
  ivec2 pixel = gatheredPixel();
  writeNoLight();
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return;
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 plane = texelFetch(gbufferNormal, pixel, 0).xyz, normal = normalForLight(pixel, plane);
  vec3 irradiance = vec3(0.0);
#ifdef MAPPED_NORMALS
  float meanLength = lengthForLight(pixel);
#endif
#ifdef GLOSSY
  Receiver seen = receiverAt(pixel, position, normal), receiver = forVirtualLights(seen, mirrors);
  vec3 glossy = vec3(0.0);
#endif
  int depthOfTree = coarsest - finest;
  for (int root = firstRoot; root < endRoot; root += rootStep) {
    int m = (root << (2 * depthOfTree)) + firstLeaf, end = (root << (2 * depthOfTree)) + endLeaf; // finest clusters
    int at = coarsest;
    while (m < end) {
      int shift = at - finest;
      ivec2 cluster = (origin >> at) + ivec2(evenBits(m >> (2 * shift)), evenBits(m >> (2 * shift + 1)));
      vec4 place = texelFetch(positions, cluster, at);
      vec3 fromLight = position - place.xyz;
      float distance2 = squaredLength(fromLight);
      if (place.a > 0.0 && at > finest && distance2 <= threshold * place.a) {
        --at;
        continue;
      }
      int within = m & ((1 << (2 * shift)) - 1);
      if (place.a > 0.0 && within == 0) {
        vec4 flux = texelFetch(fluxes, cluster, at);
        vec3 direction = fromLight * inversesqrt(distance2);
        vec3 n = texelFetch(normals, cluster, at).xyz;
        float cosineLight = dot(n, direction) * inversesqrt(max(dot(n, n), 1e-12));
        float cosine = max(-dot(normal, direction), 0.0), cosineSlopes = cosine;
#ifdef MAPPED_NORMALS
        bool above = dot(plane, direction) < 0.0;
        cosineSlopes = above ? meanCosine(-dot(normal, direction), meanLength) : 0.0;
        cosine = above ? cosine : 0.0;
#endif
        float fall = max(cosineLight, 0.0) / (distance2 + flux.a * diskFactor);
        vec3 light = flux.rgb * (0.318309886 * min(cosine * fall, largestG));
        irradiance += flux.rgb * (0.318309886 * min(cosineSlopes * fall, largestG));
#ifdef GLOSSY
        float widening = lobeSpread(spread, flux.a, cosineLight, distance2);
        glossy += light * glossyReflectance(receiver, -direction, widening);
#endif
      }
      m += (1 << (2 * shift)) - within;
      at = min(coarsest, finest + findLSB(m | (1 << (2 * depthOfTree))) / 2);
    }
  }
  outIrradiance = vec4(irradiance * float(rootStep), 1.0);
#ifdef GLOSSY
  outGlossy = vec4(glossy * float(rootStep) / glossyTint(seen), 1.0);
#endif
}
