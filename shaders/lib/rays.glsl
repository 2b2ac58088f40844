// Rays through the scene's triangles (engine/trace/flat_scene.h). Two levels, each a loop over a list of nodes in depth-
// first order, without a stack: the node's number only grows, so that every ray ends. Storage bindings 1 to 6 belong to it.
// Meets a triangle where Embree does: edges belong to both triangles, so that nothing slips through joints (Woop et al.
// 2013, "Watertight ray/triangle intersection"), boxes are widened by what rounding takes (Ize 2013).
#include "shared/coverage.h"
#include "shared/ray_scene.h"

layout(std430, binding = 1) restrict readonly buffer RayTop { BvhNode topNodes[]; };
layout(std430, binding = 2) restrict readonly buffer RayInstances { RayInstance rayInstances[]; };
layout(std430, binding = 3) restrict readonly buffer RayNodes { BvhNode rayNodes[]; };
layout(std430, binding = 4) restrict readonly buffer RayTriangles { RayTriangle rayTriangles[]; };
layout(std430, binding = 5) restrict readonly buffer RayMasks { RayMask rayMasks[]; };
layout(std430, binding = 6) restrict readonly buffer RayTexels { uint rayTexels[]; };
uniform int topNodeCount;
uniform int testAlpha; // 0: masks count as solid
uniform float blendedFrom; // metres from a ray's start within which it passes what blends (RayQuery)

struct RayHit {
  float t; // in units of the direction; infinite: nothing met
  uint instance, triangle;
  vec2 barycentric; // weights of the second and third corner
};

const uint kRayNone = 0xffffffffu;

int rayWrapped(int i, int size, uint wrap) {
  if (wrap == 2u) return clamp(i, 0, size - 1);
  int period = wrap == 1u ? 2 * size : size;
  int m = (i + period) % period; // i ≥ −1; of numbers below 0 the language leaves % open
  return m < size ? m : 2 * size - 1 - m;
}

float rayTexel(RayMask mask, int x, int y) {
  uint at = mask.firstTexel + uint(rayWrapped(y, mask.height, (mask.modes >> 2) & 3u) * mask.width +
                                   rayWrapped(x, mask.width, mask.modes & 3u));
  return float((rayTexels[at >> 2] >> (8u * (at & 3u))) & 255u) / 255.0;
}

/// As sampleTexture.
float rayTexelCoordinate(float uv, int size, uint wrap) {
  return (wrap == 2u ? clamp(uv, -1.0, 2.0) : uv - 2.0 * floor(0.5 * uv)) * float(size);
}

/// `blends`: whether what blends is met.
bool cutOut(RayMask mask, vec2 barycentric, uint key, uint instance, bool blends) {
  vec3 at = mask.corners[0].xyz * (1.0 - barycentric.x - barycentric.y) + mask.corners[1].xyz * barycentric.x +
            mask.corners[2].xyz * barycentric.y;
  float alpha = at.z;
  if (mask.width > 0) {
    vec2 p = vec2(rayTexelCoordinate(at.x, mask.width, mask.modes & 3u),
                  rayTexelCoordinate(at.y, mask.height, (mask.modes >> 2) & 3u));
    if ((mask.modes & 16u) != 0u) {
      alpha *= rayTexel(mask, int(floor(p.x)), int(floor(p.y)));
    } else {
      vec2 lo = floor(p - 0.5), f = p - 0.5 - lo;
      ivec2 i = ivec2(lo);
      alpha *= mix(mix(rayTexel(mask, i.x, i.y), rayTexel(mask, i.x + 1, i.y), f.x),
                   mix(rayTexel(mask, i.x, i.y + 1), rayTexel(mask, i.x + 1, i.y + 1), f.x), f.y);
    }
  }
  if (mask.corners[0].w < 0.0) return !blends || !isCovered(alpha, key, instance, uint(mask.corners[1].w));
  return alpha < mask.corners[0].w;
}

/// Inverse direction whose products with lengths are numbers.
vec3 rayInverse(vec3 direction) {
  vec3 sides = mix(vec3(1.0), vec3(-1.0), lessThan(direction, vec3(0.0)));
  return 1.0 / (sides * max(abs(direction), vec3(1e-37)));
}

bool meetsBox(vec3 lo, vec3 hi, vec3 origin, vec3 inverse, float tMax) {
  vec3 a = (lo - origin) * inverse, b = (hi - origin) * inverse;
  vec3 first = min(a, b), last = max(a, b);
  float enter = max(max(first.x, first.y), max(first.z, 0.0));
  float leave = min(min(last.x, last.y), min(last.z, tMax));
  return enter <= leave * 1.0000008; // 1 + 6 · 2⁻²³
}

/// The axis along which the ray goes farthest becomes the third.
vec3 rayTurned(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }

/// Where a triangle is met nearer than `hit`, it becomes the hit.
void meetTriangle(uint index, vec3 origin, vec3 shear, int axis, uint key, float from, uint instance, inout RayHit hit,
                  inout bool met) {
  RayTriangle triangle = rayTriangles[index];
  vec3 a = rayTurned(triangle.p0 - origin, axis), b = rayTurned(triangle.p1 - origin, axis),
       c = rayTurned(triangle.p2 - origin, axis);
  precise vec2 pa = a.xy - shear.xy * a.z, pb = b.xy - shear.xy * b.z, pc = c.xy - shear.xy * c.z;
  precise float u = pc.x * pb.y - pc.y * pb.x, v = pa.x * pc.y - pa.y * pc.x, w = pb.x * pa.y - pb.y * pa.x;
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return;
  float sum = u + v + w;
  if (sum == 0.0) return;
  float t = shear.z * (u * a.z + v * b.z + w * c.z) / sum;
  if (!(t > 0.0 && t <= hit.t)) return;
  vec2 barycentric = vec2(v, w) / sum;
  if (testAlpha != 0 && triangle.mask != kRayNone &&
      cutOut(rayMasks[triangle.mask], barycentric, key, instance, t >= from))
    return;
  hit.t = t;
  hit.triangle = triangle.triangle;
  hit.barycentric = barycentric;
  met = true;
}

/// What the ray meets in (0, tMax]; with `any` the first that is found.
/// `key`: of chances of meeting what is blended; 0: by the ray itself.
RayHit rayHit(vec3 origin, vec3 direction, float tMax, bool any, uint key) {
  if (key == 0u) key = rayKey(origin, direction);
  float from = blendedFrom / length(direction);
  RayHit hit = RayHit(tMax, kRayNone, 0u, vec2(0.0));
  vec3 inverse = rayInverse(direction);
  bool done = false;
  for (uint top = 0u; top < uint(topNodeCount) && !done;) {
    BvhNode above = topNodes[top];
    if (!meetsBox(above.lo, above.hi, origin, inverse, hit.t)) {
      top = above.skip;
      continue;
    }
    ++top;
    if (above.leaf == 0u) continue;
    RayInstance instance = rayInstances[above.leaf >> 3];
    vec3 o = vec3(dot(instance.objectFromWorld[0], vec4(origin, 1.0)), dot(instance.objectFromWorld[1], vec4(origin, 1.0)),
                  dot(instance.objectFromWorld[2], vec4(origin, 1.0)));
    vec3 d = vec3(dot(instance.objectFromWorld[0].xyz, direction), dot(instance.objectFromWorld[1].xyz, direction),
                  dot(instance.objectFromWorld[2].xyz, direction));
    vec3 inv = rayInverse(d), far = abs(d);
    int axis = far.x >= far.y && far.x >= far.z ? 0 : far.y >= far.z ? 1 : 2;
    vec3 turned = rayTurned(d, axis);
    vec3 shear = vec3(turned.xy, 1.0) / turned.z;
    bool met = false;
    for (uint at = 0u; at < instance.nodes && !done;) {
      BvhNode node = rayNodes[instance.firstNode + at];
      if (!meetsBox(node.lo, node.hi, o, inv, hit.t)) {
        at = node.skip;
        continue;
      }
      ++at;
      uint first = instance.firstTriangle + (node.leaf >> 3);
      for (uint k = 0u; k < (node.leaf & 7u); ++k)
        meetTriangle(first + k, o, shear, axis, key, from, instance.instance, hit, met);
      done = any && met;
    }
    if (met) hit.instance = instance.instance;
  }
  if (hit.instance == kRayNone) hit.t = uintBitsToFloat(0x7f800000u); // infinite
  return hit;
}

/// Whether something lies on the segment.
bool rayBlocked(vec3 origin, vec3 direction, float tMax, uint key) {
  return rayHit(origin, direction, tMax, true, key).instance != kRayNone;
}
