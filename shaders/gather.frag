#version 450
// Irradiance from VPLs (or samples of emissive surfaces): E = Σ L·a·cosx·cosy/(r² + a/π)·V.
// One draw covers one 4×4 subset of the pixels, which lie side by side, or all pixels (stride 1).
// Variants: SHADOWS (paraboloid maps), SMOOTH_SHADOWS (bilinear comparison).
#include "lib/gbuffer.glsl"
#include "shared/octahedral.h"
#include "shared/shadow_lookup.h"
#include "shared/vpl_light.h"

const int kClasses = 16, kLightsPerClass = 128; // a chunk of 2048 lights: see VplLights in gi/render/passes.h
layout(std140, binding = 1) uniform Lights { VplLight lights[kClasses * kLightsPerClass]; };
#ifdef SMOOTH_SHADOWS
layout(binding = 2) uniform sampler2DArrayShadow maps;
#else
layout(binding = 2) uniform sampler2DArray maps;
#endif
uniform ivec2 tileOrigin;   // of this draw's sub-image, pixels
uniform ivec2 subset;       // (x mod 4, y mod 4) of its pixels
uniform int stride;         // 4, or 1 for all pixels
uniform int firstClass;
uniform int classCount;
uniform int perClass;       // lights in each class
uniform float scale;        // 16 for one class of 16, 1 for all
uniform float diskFactor;   // 1/π, or 0 for a bare 1/r²
uniform float largestG;     // 1/m²
uniform float farDistance;  // metres at map value 1
uniform float biasTexels;
layout(location = 0) out vec4 outIrradiance;

#ifdef SHADOWS
/// 1 where the light's map shows nothing nearer than the receiver.
float visibility(int layer, vec3 normalLight, vec3 towardsReceiver, float distance, float cosineReceiver) {
  float resolution = float(textureSize(maps, 0).x);
  vec3 lookup = paraboloidLookup(normalLight, towardsReceiver, distance, cosineReceiver, resolution, biasTexels, farDistance);
#ifdef SMOOTH_SHADOWS
  return texture(maps, vec4(lookup.xy, layer, lookup.z / farDistance));
#else
  return texelFetch(maps, ivec3(ivec2(lookup.xy * resolution), layer), 0).r >= lookup.z / farDistance ? 1.0 : 0.0;
#endif
}
#endif

void main() {
  ivec2 pixel = (ivec2(gl_FragCoord.xy) - tileOrigin) * stride + subset;
  outIrradiance = vec4(0.0);
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return;
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;

  vec3 irradiance = vec3(0.0);
  for (int c = firstClass; c < firstClass + classCount; ++c) {
    for (int i = 0; i < perClass; ++i) {
      VplLight light = lights[c * kLightsPerClass + i];
      float area = light.powerArea.w;
      if (area == 0.0) continue; // empty slot
      vec3 normalLight = unitFromOctahedral(unpackSnorm2x16(floatBitsToUint(light.positionNormal.w)));
      vec3 toLight = light.positionNormal.xyz - position;
      float distance2 = max(dot(toLight, toLight), 1e-12);
      float distance = sqrt(distance2);
      vec3 towardsLight = toLight / distance;
      float cosineReceiver = dot(normal, towardsLight);
      float cosineLight = -dot(normalLight, towardsLight);
      if (!(cosineReceiver > 0.0 && cosineLight > 0.0)) continue;
      float g = min(cosineReceiver * cosineLight / (distance2 + area * diskFactor), largestG);
#ifdef SHADOWS
      g *= visibility(i * kClasses + c, normalLight, -towardsLight, distance, cosineReceiver);
#endif
      irradiance += light.powerArea.rgb * g;
    }
  }
  outIrradiance = vec4(irradiance * scale, 1.0);
}
