// What a VPL brings to a surface point, for gathering and for splatting. Variants: SHADOWS (paraboloid maps, unit 2),
// GLOSSY (the receivers' lobes too), CHECKED (SHADOWS: a ray is to check what the map says of one of the pairs).
#include "gbuffer.glsl"
#ifdef GLOSSY
#include "receiver.glsl"
#endif
#include "shared/shadow_lookup.h"
#include "shared/vpl_light.h"

// Half of the classes of a chunk of 2048 lights: see PackedLights in gi/contract/virtual_lights.h
#ifdef LISTS
layout(binding = 3) uniform samplerBuffer lightTexels;
VplLight lightAt(int i) {
  i *= 4;
  return VplLight(texelFetch(lightTexels, i), texelFetch(lightTexels, i + 1), texelFetch(lightTexels, i + 2),
                  texelFetch(lightTexels, i + 3));
}
#else
layout(std140, binding = 1) uniform Lights { VplLight lights[kClassesPerLightBlock * kLightsPerClass]; };
#endif
layout(binding = 2) uniform sampler2DArray maps;
uniform float diskFactor;    // GatherSettings::disk / π; 0 for a bare 1/r²
uniform float largestG;      // 1/m²
uniform float spread;        // GLOSSY: GatherSettings::spread
uniform float mirrors;       // GLOSSY: 1 where rays bring what smooth surfaces mirror
uniform float farDistance;   // metres at map value 1
uniform float mapResolution; // texels
uniform float biasTexels;    // ShadowSettings::bias

/// A surface point of the image.
struct Surface {
  vec3 position, normal, forLight; // normalForLight
#ifdef MAPPED_NORMALS
  float meanLength; // lengthForLight
#endif
#ifdef GLOSSY
  Receiver receiver; // forVirtualLights
  vec3 tint;         // glossyTint
#endif
};

/// What VPLs brought to it.
struct Received {
  vec3 irradiance;
#ifdef GLOSSY
  vec3 glossy; // radiance towards the camera
#endif
#ifdef CHECKED
  // One light, drawn in proportion to what it would bring were all lights seen (luminances).
  float number;  // uniform in [0, 1), as far as it is not used up
  float unseen;  // what all lights would bring
  float drawn;   // what the one drawn would
  float term;    // its geometry term; negative where its map says shadowed
  int layer;     // its map's
#endif
};

/// `depth` is the pixel's and not 0.
Surface surfaceAt(ivec2 pixel, float depth) {
  Surface s;
  s.position = positionFromDepth(pixel, depth);
  s.normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  s.forLight = normalForLight(pixel, s.normal);
#ifdef MAPPED_NORMALS
  s.meanLength = lengthForLight(pixel);
#endif
#ifdef GLOSSY
  Receiver seen = receiverAt(pixel, s.position, s.forLight);
  s.receiver = forVirtualLights(seen, mirrors);
  s.tint = glossyTint(seen);
#endif
  return s;
}

Received receivedNothing() {
  Received r;
  r.irradiance = vec3(0.0);
#ifdef GLOSSY
  r.glossy = vec3(0.0);
#endif
#ifdef CHECKED
  r.number = r.unseen = r.drawn = r.term = 0.0;
  r.layer = 0;
#endif
  return r;
}

#ifdef CHECKED
/// The light takes the place of the one drawn so far with the chance of its share. What is left of the number is uniform
/// again, either way.
void draw(inout Received sum, VplLight light, int layer, float g, bool lit) {
  float brings = g * dot(light.powerNormalX.rgb, vec3(0.2126, 0.7152, 0.0722)), before = sum.unseen;
  sum.unseen += brings;
  float at = sum.number * sum.unseen;
  bool takes = at < brings;
  sum.number = takes ? at / brings : before > 0.0 ? (at - brings) / before : sum.number;
  sum.drawn = takes ? brings : sum.drawn;
  sum.term = takes ? (lit ? g : -g) : sum.term;
  sum.layer = takes ? layer : sum.layer;
}
#endif

#ifdef SHADOWS
/// 1 where the light's map shows nothing nearer than the receiver in direction d. `d` and the receiver's normal `n` are
/// in the light's frame.
float visibility(int layer, vec3 d, vec3 n, float distance, float cosine) {
  vec2 uv = paraboloidFromDirection(d);
  // Where no light arrives anyway, all look at one texel: the loop is bound by the cache.
  ivec2 texel = d.z > 0.0 && cosine > 0.0 ? ivec2(uv * mapResolution) : ivec2(0);
  float met = paraboloidShare(texelFetch(maps, ivec3(texel, layer), 0).r) * farDistance;
  vec2 centre = (vec2(texel) + 0.5) * (2.0 / mapResolution) - 1.0;
  return paraboloidLit(met, centre, n, distance, cosine, biasTexels, mapResolution) ? 1.0 : 0.0;
}
#endif

vec3 inFrame(VplLight light, vec3 lightNormal, vec3 v) {
  return vec3(dot(light.tangentNormalY.xyz, v), dot(light.bitangentNormalZ.xyz, v), dot(lightNormal, v));
}

/// E = L·a·cosx·cosy/(r² + disk·a/π)·V. No branches: pixels of a group disagree nearly always, and software Mesa pays for
/// every mask. An empty slot has no power. `layer` is its map's. It counts `times`.
void receive(inout Received sum, Surface s, VplLight light, int layer, float times) {
  vec3 fromLight = s.position - light.positionArea.xyz;
  float distance2 = squaredLength(fromLight);
  float inverseDistance = inversesqrt(distance2);
  vec3 direction = fromLight * inverseDistance;
  float cosineReceiver = -dot(s.forLight, direction), cosinePlane = cosineReceiver;
#ifdef MAPPED_NORMALS
  cosinePlane = -dot(s.normal, direction);
  cosineReceiver = cosinePlane > 0.0 ? cosineReceiver : 0.0;
  float cosineSlopes = cosinePlane > 0.0 ? meanCosine(-dot(s.forLight, direction), s.meanLength) : 0.0;
#endif
  vec3 lightNormal = vec3(light.powerNormalX.w, light.tangentNormalY.w, light.bitangentNormalZ.w);
  vec3 d = inFrame(light, lightNormal, direction);
  float fall = max(d.z, 0.0) / (distance2 + light.positionArea.w * diskFactor);
  float g = min(max(cosineReceiver, 0.0) * fall, largestG) * times, gLobe = g;
#ifdef MAPPED_NORMALS
  g = min(cosineSlopes * fall, largestG) * times;
#endif
#ifdef SHADOWS
  float lit = visibility(layer, d, inFrame(light, lightNormal, s.normal), distance2 * inverseDistance, cosinePlane);
#ifdef CHECKED
  draw(sum, light, layer, g, lit > 0.0);
#endif
  g *= lit, gLobe *= lit;
#endif
  sum.irradiance += light.powerNormalX.rgb * g;
#ifdef GLOSSY
  float widening = lobeSpread(spread, light.positionArea.w, d.z, distance2);
  sum.glossy += light.powerNormalX.rgb * (gLobe * glossyReflectance(s.receiver, -direction, widening));
#endif
}
