#version 450
// One step of light through the volume (Kaplanyan and Dachsbacher 2010, section 4.3): each cell takes from its six
// neighbours what leaves them towards its five other faces, and sends it on through each of these as a cosine lobe.
// INJECT: takes what was deposited instead. FACES: lobes look along the faces' normals, as published; else the way that
// the light came.
//
// Two bands cannot hold a lobe, and dip below zero behind it. Negative light is left out, and the rest scaled so that a
// cell sends out what it holds, not more (without: an eighth more in every step).
#include "shared/light_volume.h"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

struct VolumeCell {
  vec4 light[3]; // red, green, blue: see light_volume.h; W
  vec4 scale;    // of each colour, on what is above zero
};
layout(std430, binding = 0) restrict readonly buffer From { VolumeCell from[]; };
layout(std430, binding = 1) restrict writeonly buffer To { VolumeCell to[]; };
layout(std430, binding = 2) restrict buffer Passed { vec4 passed[]; }; // by cell and face +x −x +y −y +z −z: W so far
layout(std430, binding = 3) restrict readonly buffer Open { vec4 open[]; };
layout(std430, binding = 4) restrict readonly buffer Deposited { vec4 deposited[]; }; // three for each cell
uniform int cells;

// Solid angles of the far face and of a side face of a neighbour, sr; the cosine between the ways to the two.
const float kFarFace = 0.40067, kSideFace = 0.42343;
const float kOut = 0.89442719, kAside = 0.44721360; // of the way to a side face

int indexOf(ivec3 at) { return (at.z * cells + at.y) * cells + at.x; }
ivec3 axisOf(int axis) { return ivec3(axis == 0, axis == 1, axis == 2); }

/// Flux of each colour that leaves a cell with `light` towards the face of its neighbour along `axis` that lies
/// `sideSign` along `sideAxis`; the far face where that is the same axis.
vec3 leaving(vec4 light[3], int axis, float axisSign, int sideAxis, float sideSign) {
  vec3 way = vec3(0.0);
  way[axis] = axisSign * (axis == sideAxis ? 1.0 : kOut);
  if (axis != sideAxis) way[sideAxis] = sideSign * kAside;
  vec4 basis = vec4(kBand0, kBand1 * way);
  vec3 intensity = vec3(dot(light[0], basis), dot(light[1], basis), dot(light[2], basis));
  return max(intensity, vec3(0.0)) * (axis == sideAxis ? kFarFace : kSideFace);
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(at, ivec3(cells)))) return;
  int self = indexOf(at);
  vec4 light[3];
#ifdef INJECT
  for (int colour = 0; colour < 3; ++colour) light[colour] = deposited[3 * self + colour];
#else
  vec3 sum = vec3(0.0), moment[3];
  for (int axis = 0; axis < 3; ++axis) moment[axis] = vec3(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) { // light that goes up, or down, the axis
      ivec3 source = side == 0 ? at - axisOf(axis) : at + axisOf(axis);
      if (source[axis] < 0 || source[axis] >= cells) continue;
      int other = indexOf(source);
      float share = open[side == 0 ? other : self][axis];
      vec4 held[3] = from[other].light;
      if (share == 0.0 || held[0].x + held[1].x + held[2].x == 0.0) continue;
      vec3 scale = from[other].scale.rgb * share;
      float sign = side == 0 ? 1.0 : -1.0;
      vec3 flux = scale * leaving(held, axis, sign, axis, 0.0);
      sum += flux;
      moment[axis] += sign * flux;
      for (int turn = 1; turn < 3; ++turn) {
        int aside = (axis + turn) % 3;
        vec3 up = scale * leaving(held, axis, sign, aside, 1.0), down = scale * leaving(held, axis, sign, aside, -1.0);
        sum += up + down;
#ifdef FACES
        moment[aside] += up - down;
#else
        moment[axis] += sign * kOut * (up + down);
        moment[aside] += kAside * (up - down);
#endif
      }
    }
  }
  vec3 x = moment[0], y = moment[1], z = moment[2];
  for (int colour = 0; colour < 3; ++colour)
    light[colour] = vec4(kLobe0 * sum[colour], kLobe1 * vec3(x[colour], y[colour], z[colour]));
#endif
  // What it will send out, by face.
  vec3 held = vec3(light[0].x, light[1].x, light[2].x) * kFluxOfBand0, all = vec3(0.0);
  vec3 sent[6];
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      float sign = side == 0 ? 1.0 : -1.0;
      vec3 flux = leaving(light, axis, sign, axis, 0.0);
      for (int turn = 1; turn < 3; ++turn) {
        int aside = (axis + turn) % 3;
        flux += leaving(light, axis, sign, aside, 1.0) + leaving(light, axis, sign, aside, -1.0);
      }
      sent[2 * axis + side] = flux;
      all += flux;
    }
  }
  vec3 scale = mix(vec3(0.0), held / max(all, vec3(1e-37)), greaterThan(all, vec3(1e-37)));
  for (int face = 0; face < 6; ++face) {
#ifdef INJECT
    passed[6 * self + face] = vec4(sent[face] * scale, 0.0);
#else
    passed[6 * self + face] += vec4(sent[face] * scale, 0.0);
#endif
  }
  for (int colour = 0; colour < 3; ++colour) to[self].light[colour] = light[colour];
  to[self].scale = vec4(scale, 0.0);
}
