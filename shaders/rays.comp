#version 450
// Rays of a list against the scene. Variants: ANY (whether anything is met).
#include "lib/rays.glsl"

layout(local_size_x = 64) in;

struct ListedRay {
  vec3 origin;
  float tMax;
  vec3 direction;
  uint key;
};
struct ListedHit {
  float t;
  uint instance, triangle; // instance 2³² − 1: nothing met
  float u, v;
};
layout(std430, binding = 0) restrict readonly buffer Rays { ListedRay rays[]; };
layout(std430, binding = 7) restrict writeonly buffer Hits {
#ifdef ANY
  uint blocked[];
#else
  ListedHit hits[];
#endif
};
uniform int count;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(count)) return;
  ListedRay ray = rays[i];
#ifdef ANY
  blocked[i] = rayBlocked(ray.origin, ray.direction, ray.tMax, ray.key) ? 1u : 0u;
#else
  RayHit hit = rayHit(ray.origin, ray.direction, ray.tMax, false, ray.key);
  hits[i] = ListedHit(hit.t, hit.instance, hit.triangle, hit.barycentric.x, hit.barycentric.y);
#endif
}
