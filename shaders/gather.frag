#version 450
// Irradiance from VPLs (or samples of emissive surfaces): E = Σ L·a·cosx·cosy/(r² + a/π)·V.
// One draw covers one 4×4 subset of the pixels, which lie side by side, or all pixels (stride 1).
// Variants: SHADOWS (paraboloid maps), SMOOTH_SHADOWS (bilinear comparison), GLOSSY (the receivers' lobes too).
#include "lib/gbuffer.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#endif
#include "shared/shadow_lookup.h"
#include "shared/vpl_light.h"

// Half of the classes of a chunk of 2048 lights: see VplLights in gi/render/passes.h
layout(std140, binding = 1) uniform Lights { VplLight lights[kClassesPerLightBlock * kLightsPerClass]; };
#ifdef SMOOTH_SHADOWS
layout(binding = 2) uniform sampler2DArrayShadow maps;
#else
layout(binding = 2) uniform sampler2DArray maps;
#endif
uniform ivec2 tileOrigin;   // of this draw's sub-image, pixels
uniform ivec2 subset;       // (x mod 4, y mod 4) of its pixels
uniform int stride;         // 4, or 1 for all pixels
uniform int firstClass;     // in the block
uniform int classCount;
uniform int blockClass;     // class that the block starts with
uniform int perClass;       // lights in each class
uniform float scale;        // 16 for one class of 16, 1 for all
uniform float diskFactor;   // GatherSettings::disk / π; 0 for a bare 1/r²
uniform float largestG;     // 1/m²
uniform float spread;       // GLOSSY: GatherSettings::spread
uniform float farDistance;  // metres at map value 1
uniform float mapResolution;  // texels
uniform float biasTexels;     // ShadowSettings::bias
layout(location = 0) out vec4 outIrradiance;
#ifdef GLOSSY
layout(location = 1) out vec4 outGlossy; // radiance over glossyTint
#endif

#ifdef SHADOWS
/// 1 where the light's map shows nothing nearer than the receiver in direction d (light's frame).
float visibility(int layer, vec3 d, float distance, float cosine) {
  float reach = paraboloidReach(distance, cosine, d.z, biasTexels, mapResolution);
  vec2 uv = paraboloidFromDirection(d);
#ifdef SMOOTH_SHADOWS
  return texture(maps, vec4(uv, layer, reach / (max(cosine, 1e-4) * farDistance) - paraboloidRounding()));
#else
  // Where no light arrives anyway, all look at one texel: the loop is bound by the cache.
  ivec2 texel = d.z > 0.0 && cosine > 0.0 ? ivec2(uv * mapResolution) : ivec2(0);
  float met = texelFetch(maps, ivec3(texel, layer), 0).r + paraboloidRounding();
  return met * farDistance * cosine >= reach ? 1.0 : 0.0;
#endif
}
#endif

void main() {
  ivec2 pixel = (ivec2(gl_FragCoord.xy) - tileOrigin) * stride + subset;
  outIrradiance = vec4(0.0);
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return;
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;

#ifdef GLOSSY
  Receiver receiver = receiverAt(pixel, position, normal);
  vec3 glossy = vec3(0.0);
#endif
  // No branches inside: pixels of a group disagree nearly always, and software Mesa pays for every mask. An empty slot
  // has no power.
  vec3 irradiance = vec3(0.0);
  for (int c = firstClass; c < firstClass + classCount; ++c) {
    for (int i = 0; i < perClass; ++i) {
      VplLight light = lights[c * kLightsPerClass + i];
      vec3 fromLight = position - light.positionArea.xyz;
      float distance2 = max(dot(fromLight, fromLight), 1e-12);
      float inverseDistance = inversesqrt(distance2);
      vec3 direction = fromLight * inverseDistance;
      float cosineReceiver = -dot(normal, direction);
      vec3 d = vec3(dot(light.tangentNormalY.xyz, direction), dot(light.bitangentNormalZ.xyz, direction),
                    dot(vec3(light.powerNormalX.w, light.tangentNormalY.w, light.bitangentNormalZ.w), direction));
      float g = max(cosineReceiver, 0.0) * max(d.z, 0.0) / (distance2 + light.positionArea.w * diskFactor);
      g = min(g, largestG);
#ifdef SHADOWS
      g *= visibility(i * kLightClasses + blockClass + c, d, distance2 * inverseDistance, cosineReceiver);
#endif
      irradiance += light.powerNormalX.rgb * g;
#ifdef GLOSSY
      glossy += light.powerNormalX.rgb * (g * glossyReflectance(receiver, -direction, lobeSpread(spread, light.positionArea.w, d.z, distance2)));
#endif
    }
  }
  outIrradiance = vec4(irradiance * scale, 1.0);
#ifdef GLOSSY
  outGlossy = vec4(glossy * scale / glossyTint(receiver), 1.0);
#endif
}
