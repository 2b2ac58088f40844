#version 450
// Three cube faces around a light's normal, seen from it, to one paraboloid map: paraboloidValue(distance over farDistance).
#include "shared/shadow_lookup.h"

layout(binding = 0) uniform sampler2DArray faces; // reversed depth, near / distance along the face's axis; 0 = nothing
uniform float resolution;   // of the paraboloid map, texels
uniform float nearDistance; // of the faces, metres
uniform float farDistance;  // metres at map value 1
uniform vec3 axisX;         // the cube's axes in the light's frame (tangent, bitangent, normal)
uniform vec3 axisY;
uniform vec3 axisZ;

float faceDepth(ivec2 texel, int face) {
  return texelFetch(faces, ivec3(clamp(texel, ivec2(0), textureSize(faces, 0).xy - 1), face), 0).r;
}

/// The lesser of the slopes on two sides; none across a texel that stands alone, before or behind both.
float slopeOf(float a, float b, float centre) {
  float lesser = abs(a) < abs(b) ? a : b;
  return a * b < 0.0 && abs(lesser) > 0.1 * centre ? 0.0 : lesser;
}

/// Reversed depth at `place`, texels. It is linear on a plane, so the nearest texel's value goes on by its slope: that of
/// the side where no other surface begins. (Without, a texel next to the receiver answers for its plane, and grazing light
/// is striped: lookups expect distances through the centres of the map's texels.)
float depthAt(vec2 place, int face) {
  ivec2 texel = ivec2(floor(place));
  float centre = faceDepth(texel, face);
  if (centre == 0.0) return 0.0;
  vec2 after = vec2(faceDepth(texel + ivec2(1, 0), face), faceDepth(texel + ivec2(0, 1), face)) - centre;
  vec2 before = centre - vec2(faceDepth(texel - ivec2(1, 0), face), faceDepth(texel - ivec2(0, 1), face));
  vec2 slope = vec2(slopeOf(after.x, before.x, centre), slopeOf(after.y, before.y, centre));
  return max(centre + dot(slope, place - vec2(texel) - 0.5), 1e-6 * centre);
}

void main() {
  gl_FragDepth = 1.0;
  vec3 d = directionFromParaboloid(gl_FragCoord.xy / resolution);
  if (d.z < -2.0 / resolution) return; // outside the disc by more than a lookup can reach
  vec3 cube = vec3(dot(axisX, d), dot(axisY, d), dot(axisZ, d));
  // Directions of the hemisphere around (1,1,1) have a positive largest component m and none below -2m: each face's
  // frustum reaches over [-2,1] on both of its axes.
  int face = cube.x >= cube.y && cube.x >= cube.z ? 0 : (cube.y >= cube.z ? 1 : 2);
  vec3 local = face == 0 ? cube.yzx : (face == 1 ? cube.zxy : cube); // right, up, forward of the face
  vec2 uv = (local.xy / local.z + 2.0) / 3.0;
  float depth = depthAt(uv * vec2(textureSize(faces, 0).xy), face);
  if (depth > 0.0) gl_FragDepth = paraboloidValue(min(nearDistance / depth / local.z / farDistance, 1.0));
}
