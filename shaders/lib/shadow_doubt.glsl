// What the four texels of a shadow map around a receiver say of it. Where they agree, and clearly, that is the answer;
// where not, the edge of a shadow or another surface is near, and the receiver goes on a list for rays.
// Variants as direct.frag.
#include "shared/shadow_doubt.h"

#ifdef CUBE_MAPS
layout(binding = 4) uniform samplerCubeArray mapDepths;
#else
layout(binding = 4) uniform sampler2DArray mapDepths;
#endif
layout(std430, binding = 0) restrict buffer Doubts {
  uint doubtCount; // may pass the room
  uint doubtRoom;
  uint doubtPad0, doubtPad1;
  ShadowDoubt doubts[];
};

const int kShadowed = 0, kLit = 1, kInDoubt = 2;

/// Depths are reversed. `plane`: of the receiver's plane in the four directions. Nearer to the light than that by up to
/// `same` is the receiver's own surface, by more than `apart` another.
int verdictOf(vec4 met, vec4 plane, vec4 same, vec4 apart) {
  if (all(lessThanEqual(met, plane + same))) return kLit;
  return all(greaterThan(met, plane + apart)) ? kShadowed : kInDoubt;
}

/// A 256th of a pixel nearer to the viewer, as a place next to the joint of two walls may lie behind the other one, and
/// above its own wall: corners that are rounded along the image sink it by the sine of its slant, of which the way to the
/// viewer takes the cosine back. (More takes from places in narrow gaps: a 64th of a pixel gave the citadel a relMSE of
/// 0.04 instead of 0.012, a 256th along the normal whatever the slant the hall 0.063 instead of 0.052.)
vec3 justBefore(vec3 position, vec3 normal) {
  vec3 way = camera.worldFromView[3].xyz - position;
  float distance = -dot(way, camera.worldFromView[2].xyz);
  float slack = placeSlack(camera, abs(distance));
  vec3 towardsViewer = camera.lens.w > 0.0 ? camera.worldFromView[2].xyz : way / max(abs(distance), 1e-30);
  float cosine = clamp(dot(normalize(towardsViewer), normal), 0.0, 1.0);
  return position + (towardsViewer + normal * max(sqrt(1.0 - cosine * cosine) - cosine, 0.0)) * slack;
}

void noteDoubt(ivec2 pixel, vec3 position, vec3 normal, uint light) {
  uint at = atomicAdd(doubtCount, 1u);
  if (at < doubtRoom) doubts[at] = ShadowDoubt(position, uint(pixel.x) | uint(pixel.y) << 16, normal, light);
}

/// Texels of depth by which a receiver's own surface may seem nearer to the light: corners are snapped to 1/256, and what
/// bends a little is no other surface yet. No more at grazing light, for there all would be one surface. (Emitters have
/// many samples, none of which decides alone: 0.2 in place of 0.05 asks a quarter fewer rays of living-room-2, relMSE
/// 0.025 instead of 0.024.)
float sameWithin(float cosine) {
#ifdef EMITTER_MAPS
  const float share = 0.2;
#else
  const float share = 0.05;
#endif
  return share * (1.0 + min(tangentOf(cosine), 8.0));
}
/// Texels of depth beyond which it is another surface.
float apartBeyond(float cosine) { return 1.0 + tangentOf(cosine); }

/// Of four texels in the order (0,0), (1,0), (0,1), (1,1) whose first is `base`.
vec4 fourAt(vec2 base, float resolution, out vec4 t) {
  vec2 lo = (base + 0.5) * (2.0 / resolution) - 1.0, hi = (base + 1.5) * (2.0 / resolution) - 1.0;
  t = vec4(lo.y, lo.y, hi.y, hi.y);
  return vec4(lo.x, hi.x, lo.x, hi.x);
}

/// Whether four texels from `base` on lie in the map.
bool inside(vec2 base, float resolution) {
  return all(greaterThanEqual(base, vec2(0.0))) && all(lessThan(base, vec2(resolution - 1.0)));
}

#ifndef CUBE_MAPS
vec4 metAt(vec2 base, float layer) {
  ivec3 at = ivec3(base, layer);
  return vec4(texelFetch(mapDepths, at, 0).r, texelFetch(mapDepths, at + ivec3(1, 0, 0), 0).r,
              texelFetch(mapDepths, at + ivec3(0, 1, 0), 0).r, texelFetch(mapDepths, at + ivec3(1, 1, 0), 0).r);
}
#endif

#ifdef SUN_MAPS
int answerOf(LightRecord light, vec3 position, vec3 normal, float cosine) {
  mat4 m = light.mapFromWorld;
  vec3 x = vec3(m[0][0], m[1][0], m[2][0]), y = vec3(m[0][1], m[1][1], m[2][1]), z = vec3(m[0][2], m[1][2], m[2][2]);
  float resolution = float(textureSize(mapDepths, 0).x);
  vec3 map = (m * vec4(position, 1.0)).xyz;
  vec2 base = floor(map.xy * resolution - 0.5);
  if (!inside(base, resolution)) return kInDoubt;
  // The plane's slope in map coordinates: rows are directions times scales.
  float depthOfMetre = length(z), facing = dot(z, normal) / dot(z, z);
  vec2 slope = -vec2(dot(x, normal) / dot(x, x), dot(y, normal) / dot(y, y)) / facing;
  vec4 t, s = fourAt(base, resolution, t);
  vec4 plane = map.z + ((s * 0.5 + 0.5) - map.x) * slope.x + ((t * 0.5 + 0.5) - map.y) * slope.y;
  float texel = light.directionTexel.w * depthOfMetre;
  float rounding = 1e-6 * (1.0 + depthOfMetre * axisDistance(position));
  return verdictOf(metAt(base, light.intensityLayer.w), plane, vec4(sameWithin(cosine) * texel + rounding),
                   vec4(apartBeyond(cosine) * texel));
}
#elif defined(EMITTER_MAPS)
int answerOf(LightRecord light, vec3 position, vec3 normal, float cosine) {
  vec3 fromLight = position - light.positionRange.xyz;
  float distance = length(fromLight), resolution = float(textureSize(mapDepths, 0).x);
  mat3 frame = mat3(light.mapFromWorld);
  vec3 d = frame * (fromLight / distance), n = frame * normal;
  vec2 base = clamp(floor(paraboloidFromDirection(d) * resolution - 0.5), 0.0, resolution - 2.0);
  vec4 t, s = fourAt(base, resolution, t);
  vec4 r2 = s * s + t * t;
  vec4 cosines = -(2.0 * (n.x * s + n.y * t) + n.z * (1.0 - r2)) / (1.0 + r2); // at the plane, in the texels' directions
  vec4 inverse = cosines * (light.coneNear.z / -dot(normal, fromLight)); // far distance over the plane's
  float texel = light.directionTexel.w * (1.0 + d.z);
  vec4 values = metAt(base, light.intensityLayer.w);
  vec4 met = vec4(paraboloidShare(values.x), paraboloidShare(values.y), paraboloidShare(values.z),
                  paraboloidShare(values.w)) * inverse; // over the plane's distance
  if (all(greaterThanEqual(met, vec4(1.0 - sameWithin(cosine) * texel)))) return kLit;
  return all(lessThan(met, vec4(1.0 - apartBeyond(cosine) * texel))) ? kShadowed : kInDoubt;
}
#else
int answerOf(LightRecord light, vec3 position, vec3 normal, float cosine) {
  vec3 fromLight = position - light.positionRange.xyz;
  float resolution = float(textureSize(mapDepths, 0).x);
  vec3 right, up, forward; // unit `forward`; the others as long as half the map's width at distance 1
#ifdef CUBE_MAPS
  const float halfWidth2 = 1.0;
  vec3 a = abs(fromLight);
  bool isX = a.x >= a.y && a.x >= a.z, isY = !isX && a.y >= a.z;
  float side = (isX ? fromLight.x : isY ? fromLight.y : fromLight.z) < 0.0 ? -1.0 : 1.0;
  forward = side * (isX ? vec3(1, 0, 0) : isY ? vec3(0, 1, 0) : vec3(0, 0, 1));
  right = isX ? vec3(0, 0, -side) : vec3(isY ? 1.0 : side, 0, 0);
  up = isY ? vec3(0, 0, side) : vec3(0, -1, 0);
#else
  mat4 m = light.mapFromWorld;
  float halfWidth2 = 0.25 * light.directionTexel.w * light.directionTexel.w * resolution * resolution;
  forward = vec3(m[0][3], m[1][3], m[2][3]);
  right = (vec3(m[0][0], m[1][0], m[2][0]) * 2.0 - forward) * halfWidth2;
  up = (vec3(m[0][1], m[1][1], m[2][1]) * 2.0 - forward) * halfWidth2;
#endif
  float distance = dot(fromLight, forward);
  vec2 at = vec2(dot(fromLight, right), dot(fromLight, up)) / (distance * halfWidth2);
  vec2 base = floor((at * 0.5 + 0.5) * resolution - 0.5);
  if (!(distance > 0.0) || !inside(base, resolution)) return kInDoubt;
#ifdef CUBE_MAPS
  vec2 corner = (base + 1.0) * (2.0 / resolution) - 1.0; // the gather's order: (0,1), (1,1), (1,0), (0,0)
  vec4 met = textureGather(mapDepths, vec4(forward + right * corner.x + up * corner.y, light.intensityLayer.w)).wzxy;
#else
  vec4 met = metAt(base, light.intensityLayer.w);
#endif
  vec4 t, s = fourAt(base, resolution, t);
  vec4 towards = dot(normal, forward) + s * dot(normal, right) + t * dot(normal, up);
  vec4 plane = light.coneNear.z * towards / dot(normal, fromLight);
  float texel = light.directionTexel.w;
  float rounding = 1e-6 * (1.0 + axisDistance(position) / distance);
  return verdictOf(met, plane, plane * (sameWithin(cosine) * texel + rounding), plane * (apartBeyond(cosine) * texel));
}
#endif
