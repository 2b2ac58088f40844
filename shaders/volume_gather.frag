#version 450
// Irradiance of pixels from the light that went through the cells around them: what passed a cell towards the surface,
// by the three faces that look there (their shares are the squares of the normal's parts, so that even light stays even).
// Trilinear, without cells behind the surface and without those that something hides from it.
#include "lib/gbuffer.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#endif
#include "lib/light_outputs.glsl"
#include "shared/light_volume.h"

layout(std430, binding = 2) restrict readonly buffer Passed { vec4 passed[]; };
layout(std430, binding = 5) restrict readonly buffer Sights { uvec2 sights[]; };
uniform vec3 corner; // world
uniform float cell;  // metres
uniform int cells;
const float kTowardsViewer = 0.5; // cells

/// Irradiance on a surface in a cell whose unit normal is given.
vec3 onSurface(int index, vec3 normal) {
  vec3 sum = vec3(0.0);
  for (int axis = 0; axis < 3; ++axis)
    sum += normal[axis] * normal[axis] * passed[6 * index + 2 * axis + (normal[axis] > 0.0 ? 1 : 0)].rgb;
  return sum;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  writeNoLight();
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 x = (position - corner) / cell + kVolumeShift * normal;
  ivec3 base = ivec3(floor(x - 0.5));
  // What sees the pixel is asked for a place a little on the way to the camera, which no surface lies between: next to
  // another surface the half cell that the pixel lies in may have its middle behind that.
  vec3 towardsViewer =
      camera.lens.w > 0.0 ? camera.worldFromView[2].xyz : normalize(camera.worldFromView[3].xyz - position);
  vec3 asked = x + kTowardsViewer * towardsViewer;
  vec3 forLight = normalForLight(pixel, normal);
#ifdef GLOSSY
  Receiver receiver = receiverAt(pixel, position, forLight);
  vec3 mirrored = reflect(-receiver.towardsViewer, forLight);
  vec3 glossy = vec3(0.0), glossyHidden = vec3(0.0);
#endif
  vec3 seen = vec3(0.0), hidden = vec3(0.0);
  float seenWeight = 0.0, hiddenWeight = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 at = base + ivec3(i & 1, i >> 1 & 1, i >> 2);
    if (any(lessThan(at, ivec3(0))) || any(greaterThanEqual(at, ivec3(cells)))) continue;
    vec3 centre = vec3(at) + 0.5;
    float weight = volumeWeight(x, centre, normal);
    if (weight == 0.0) continue;
    int index = (at.z * cells + at.y) * cells + at.x;
    int part = volumePart(asked, centre);
    bool sees = (sights[index][part >> 5] >> (part & 31) & 1u) != 0u;
    vec3 light = weight * onSurface(index, forLight);
    if (sees) seen += light, seenWeight += weight;
    else hidden += light, hiddenWeight += weight;
#ifdef GLOSSY
    vec3 lobe = weight * onSurface(index, mirrored);
    if (sees) glossy += lobe;
    else glossyHidden += lobe;
#endif
  }
  // In a gap narrower than a cell no centre may see anything.
  bool any = seenWeight > 1e-4;
  float inverse = (any ? 1.0 / seenWeight : hiddenWeight > 0.0 ? 1.0 / hiddenWeight : 0.0) / (cell * cell);
  outIrradiance = vec4((any ? seen : hidden) * inverse, 1.0);
#ifdef GLOSSY
  vec3 radiance = (any ? glossy : glossyHidden) * inverse * 0.318309886;
  outGlossy = vec4(evenGlossy(pixel, receiver, radiance), 1.0);
#endif
}
