#version 450
// Direct irradiance from one block of lights with their shadow maps. Variants by how the maps are made: CUBE_MAPS
// (point lights and wide spots), SPOT_MAPS, SUN_MAPS (directional lights and directions of the sky); GLOSSY (the
// receivers' lobes too).
#include "lib/gbuffer.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#endif
#include "shared/light_record.h"

layout(std140, binding = 1) uniform Lights { LightRecord lights[kLightsPerBlock]; };
#ifdef CUBE_MAPS
layout(binding = 2) uniform samplerCubeArrayShadow maps;
#else
layout(binding = 2) uniform sampler2DArrayShadow maps;
#endif
uniform int lightCount;
layout(location = 0) out vec4 outIrradiance;
#ifdef GLOSSY
layout(location = 1) out vec4 outGlossy; // radiance over glossyTint
#endif

/// glTF: smooth range window and cone (KHR_lights_punctual, reference formulas), over r².
float attenuation(LightRecord light, vec3 towardsLight, float distance2) {
  float window = clamp(1.0 - distance2 * distance2 * light.positionRange.w, 0.0, 1.0);
  float cone = clamp(dot(light.directionTexel.xyz, -towardsLight) * light.coneNear.x + light.coneNear.y, 0.0, 1.0);
  return window * cone * cone / distance2;
}

/// The receiver, moved along its normal by as much as `texels` of the map can differ in depth on its plane: the depth
/// error is texels·tanθ along the ray, so the shift is texels·sinθ; half a texel more is for the rasteriser's rounding.
vec3 liftedReceiver(vec3 position, vec3 normal, float cosine, float texel, float texels) {
  return position + normal * (texel * (texels * sqrt(max(0.0, 1.0 - cosine * cosine)) + 0.5));
}

#ifndef CUBE_MAPS
/// 3×3 texels through four bilinear comparisons.
float filteredShadow(vec3 map, float layer) {
  vec2 step = 0.5 / vec2(textureSize(maps, 0).xy);
  return 0.25 * (texture(maps, vec4(map.xy + vec2(-step.x, -step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(step.x, -step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(-step.x, step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(step.x, step.y), layer, map.z)));
}
#endif

float axisDistance(vec3 v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = vec4(0.0);
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 irradiance = vec3(0.0);
#ifdef GLOSSY
  Receiver receiver = receiverAt(pixel, position, normal);
  vec3 glossy = vec3(0.0);
#endif

  for (int i = 0; i < lightCount; ++i) {
    LightRecord light = lights[i];
    float layer = light.intensityLayer.w;
#ifdef SUN_MAPS
    vec3 towardsLight = -light.directionTexel.xyz;
    float cosine = dot(normal, towardsLight);
    if (!(cosine > 0.0)) continue;
    vec3 lifted = liftedReceiver(position, normal, cosine, light.directionTexel.w, 2.0);
    float weight = cosine * filteredShadow((light.mapFromWorld * vec4(lifted, 1.0)).xyz, layer);
#else
    vec3 toLight = light.positionRange.xyz - position;
    float distance2 = max(dot(toLight, toLight), 1e-20);
    vec3 towardsLight = toLight * inversesqrt(distance2);
    float cosine = dot(normal, towardsLight);
    float weight = cosine * attenuation(light, towardsLight, distance2);
    if (!(weight > 0.0)) continue;
#ifdef CUBE_MAPS
    float texel = light.directionTexel.w * axisDistance(toLight);
    vec3 fromLight = liftedReceiver(position, normal, cosine, texel, 1.5) - light.positionRange.xyz;
    weight *= texture(maps, vec4(fromLight, layer), light.coneNear.z / axisDistance(fromLight));
#else
    float texel = light.directionTexel.w * dot(light.directionTexel.xyz, -toLight);
    vec4 map = light.mapFromWorld * vec4(liftedReceiver(position, normal, cosine, texel, 2.0), 1.0);
    weight *= filteredShadow(map.xyz / map.w, layer);
#endif
#endif
    irradiance += light.intensityLayer.rgb * weight;
#ifdef GLOSSY
    glossy += light.intensityLayer.rgb * (weight * glossyReflectance(receiver, towardsLight, 0.0));
#endif
  }
  outIrradiance = vec4(irradiance, 1.0);
#ifdef GLOSSY
  outGlossy = vec4(glossy / glossyTint(receiver), 1.0);
#endif
}
