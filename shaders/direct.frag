#version 450
// Direct irradiance from one block of lights with their shadow maps. Variants by how the maps are made: CUBE_MAPS
// (point lights and wide spots), SPOT_MAPS, SUN_MAPS (directional lights and directions of the sky), EMITTER_MAPS
// (samples of emissive surfaces); with SUN_MAPS, SKY (directions of the sky); DOUBTS (no light where a map is in doubt,
// which is noted for rays) and LIT (the light of such pairs that see one another: a point each); GLOSSY (the receivers'
// lobes too).
#include "lib/gbuffer.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#endif
#include "shared/light_record.h"
#ifdef EMITTER_MAPS
#include "shared/shadow_lookup.h"
#endif

layout(std140, binding = 1) uniform Lights { LightRecord lights[kLightsPerBlock]; };
uniform float spread; // GLOSSY, EMITTER_MAPS: GatherSettings::spread
#ifdef LIT
layout(location = 0) flat in int litLight;
layout(location = 1) flat in float litTransmittance;
#else
uniform int lightCount;
uniform int firstLight; // DOUBTS: of the block, among the frame's direct lights
#endif
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

float tangentOf(float cosine) { return sqrt(max(0.0, 1.0 - cosine * cosine)) / max(cosine, 1e-4); }
float axisDistance(vec3 v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

#ifdef DOUBTS
#include "lib/shadow_doubt.glsl"
#endif
#if !defined(LIT) && (!defined(DOUBTS) || defined(SKY))
#include "lib/filtered_shadow.glsl"
#endif

/// Irradiance per intensity and cosine where nothing is between. Samples of emitters are disks of their area:
/// E = L·a·cosx·cosy/(r² + a/π).
float unshadowed(LightRecord light, vec3 position, vec3 normal, out vec3 towardsLight, out float cosine) {
#ifdef SUN_MAPS
  towardsLight = -light.directionTexel.xyz;
  cosine = dot(normal, towardsLight);
  return 1.0;
#else
  vec3 toLight = light.positionRange.xyz - position;
  float distance2 = squaredLength(toLight);
  towardsLight = toLight * inversesqrt(distance2);
  cosine = dot(normal, towardsLight);
#ifdef EMITTER_MAPS
  float cosineLight = max(-dot(light.directionTexel.xyz, towardsLight), 0.0);
  return cosineLight / (distance2 + light.positionRange.w * 0.318309886);
#else
  return attenuation(light, towardsLight, distance2);
#endif
#endif
}

#if defined(DOUBTS) && defined(SKY)
/// Whether any direction of this block (of 128) is lit without doubt. Its few directions stand for a sky that comes from
/// everywhere, so their shadows are blurred; but a place that sees none of it must stay black, however thin the walls.
bool seesSky(vec3 position, vec3 normal) {
  for (int i = 0; i < lightCount; ++i) {
    vec3 towardsLight;
    float cosine, fall = unshadowed(lights[i], position, normal, towardsLight, cosine);
    if (fall * cosine > 0.0 && answerOf(lights[i], position, normal, cosine) == kLit) return true;
  }
  return false;
}
#endif

#ifdef GLOSSY
/// Of lobes, by the light's own size.
float wideningOf(LightRecord light, vec3 position) {
#ifdef EMITTER_MAPS
  vec3 fromLight = position - light.positionRange.xyz;
  float distance2 = squaredLength(fromLight);
  float cosine = max(dot(light.directionTexel.xyz, fromLight) * inversesqrt(distance2), 0.0);
  return lobeSpread(spread, light.positionRange.w, cosine, distance2);
#else
  return 0.0;
#endif
}
#endif

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
  vec3 forLight = normalForLight(pixel, normal);
#ifdef MAPPED_NORMALS
  float meanLength = lengthForLight(pixel);
#endif
  vec3 irradiance = vec3(0.0);
#ifdef GLOSSY
  Receiver receiver = receiverAt(pixel, position, forLight);
  vec3 glossy = vec3(0.0);
#endif

#ifdef LIT
  const int first = litLight, end = litLight + 1;
#else
  const int first = 0, end = lightCount;
#endif
#ifdef DOUBTS
  vec3 place = justBefore(position, normal);
#ifdef SKY
  bool open = seesSky(place, normal);
#endif
#endif
  for (int i = first; i < end; ++i) {
    LightRecord light = lights[i];
    vec3 towardsLight;
    float cosine, weight = unshadowed(light, position, forLight, towardsLight, cosine);
    float weightOfLobe = weight * max(cosine, 0.0);
#ifdef MAPPED_NORMALS
    weight *= meanCosine(cosine, meanLength);
    cosine = dot(normal, towardsLight);
    if (!(weight > 0.0 && cosine > 0.0)) continue;
#else
    weight = weightOfLobe;
    if (!(weight > 0.0)) continue;
#endif
    float seen = 1.0;
#ifdef DOUBTS
#ifdef SKY
    if (open) {
      seen = shadowOf(light, position, normal, cosine);
    } else
#endif
    {
      int answer = answerOf(light, place, normal, cosine);
      if (answer == kInDoubt) noteDoubt(pixel, place, normal, uint(firstLight + i));
      if (answer != kLit) continue;
    }
#elif defined(LIT)
    seen = litTransmittance;
#else
    seen = shadowOf(light, position, normal, cosine);
#endif
    irradiance += light.intensityLayer.rgb * (weight * seen);
#ifdef GLOSSY
    vec3 lobe = glossyReflectance(receiver, towardsLight, wideningOf(light, position));
    glossy += light.intensityLayer.rgb * (weightOfLobe * seen * lobe);
#endif
  }
  outIrradiance = vec4(irradiance, 1.0);
#ifdef GLOSSY
  outGlossy = vec4(glossy / glossyTint(receiver), 1.0);
#endif
}
