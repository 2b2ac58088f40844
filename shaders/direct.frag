#version 450
// Direct irradiance from one block of punctual lights or sky directions, with their shadow maps.
#include "lib/gbuffer.glsl"
#include "shared/punctual_light.h"

layout(std140, binding = 1) uniform Lights { PunctualLight lights[kLightsPerBlock]; };
layout(binding = 2) uniform samplerCubeArrayShadow cubeMaps;
layout(binding = 3) uniform sampler2DArrayShadow spotMaps;
layout(binding = 4) uniform sampler2DArrayShadow sunMaps;
// In the block: lights with cube maps first, then spots, then directions.
uniform int cubeCount;
uniform int spotCount;
uniform int sunCount;
layout(location = 0) out vec4 outIrradiance;

/// glTF: smooth range window and cone (KHR_lights_punctual, reference formulas).
float attenuation(PunctualLight light, vec3 towardsLight, float distance2) {
  float window = clamp(1.0 - distance2 * distance2 * light.positionRange.w, 0.0, 1.0);
  float cone = clamp(dot(light.directionTexel.xyz, -towardsLight) * light.coneNear.x + light.coneNear.y, 0.0, 1.0);
  return window * cone * cone / distance2;
}

/// The receiver, moved along its normal by as much as `texels` of the map can differ in depth on its plane: the depth
/// error is texels·tanθ along the ray, so the shift is texels·sinθ.
vec3 liftedReceiver(vec3 position, vec3 normal, float cosine, float texel, float texels) {
  return position + normal * (texel * (texels * sqrt(max(0.0, 1.0 - cosine * cosine)) + 0.05));
}

/// 3×3 texels through four bilinear comparisons.
float filteredShadow(sampler2DArrayShadow maps, vec3 map, float layer) {
  vec2 step = 0.5 / vec2(textureSize(maps, 0).xy);
  return 0.25 * (texture(maps, vec4(map.xy + vec2(-step.x, -step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(step.x, -step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(-step.x, step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(step.x, step.y), layer, map.z)));
}

float axisDistance(vec3 v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = vec4(0.0);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 irradiance = vec3(0.0);

  for (int i = 0; i < cubeCount; ++i) {
    PunctualLight light = lights[i];
    vec3 toLight = light.positionRange.xyz - position;
    float distance2 = max(dot(toLight, toLight), 1e-12);
    vec3 towardsLight = toLight * inversesqrt(distance2);
    float cosine = dot(normal, towardsLight);
    float weight = cosine * attenuation(light, towardsLight, distance2);
    if (!(weight > 0.0)) continue;
    float texel = light.directionTexel.w * axisDistance(toLight);
    vec3 fromLight = liftedReceiver(position, normal, cosine, texel, 1.5) - light.positionRange.xyz;
    float reference = light.coneNear.z / axisDistance(fromLight);
    irradiance += light.intensityLayer.rgb * weight * texture(cubeMaps, vec4(fromLight, light.intensityLayer.w), reference);
  }
  for (int i = cubeCount; i < cubeCount + spotCount; ++i) {
    PunctualLight light = lights[i];
    vec3 toLight = light.positionRange.xyz - position;
    float distance2 = max(dot(toLight, toLight), 1e-12);
    vec3 towardsLight = toLight * inversesqrt(distance2);
    float cosine = dot(normal, towardsLight);
    float weight = cosine * attenuation(light, towardsLight, distance2);
    if (!(weight > 0.0)) continue;
    float texel = light.directionTexel.w * dot(light.directionTexel.xyz, -toLight);
    vec4 map = light.mapFromWorld * vec4(liftedReceiver(position, normal, cosine, texel, 2.0), 1.0);
    irradiance += light.intensityLayer.rgb * weight * filteredShadow(spotMaps, map.xyz / map.w, light.intensityLayer.w);
  }
  for (int i = cubeCount + spotCount; i < cubeCount + spotCount + sunCount; ++i) {
    PunctualLight light = lights[i];
    float cosine = -dot(normal, light.directionTexel.xyz);
    if (!(cosine > 0.0)) continue;
    vec4 map = light.mapFromWorld * vec4(liftedReceiver(position, normal, cosine, light.directionTexel.w, 2.0), 1.0);
    irradiance += light.intensityLayer.rgb * cosine * filteredShadow(sunMaps, map.xyz, light.intensityLayer.w);
  }
  outIrradiance = vec4(irradiance, 1.0);
}
