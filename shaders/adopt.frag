#version 450
// A host's depth, normals and emission in our conventions (GBuffer and HostConventions, gi/contract/surfaces.h).
#include "shared/camera_block.h"
#include "shared/octahedral.h"

layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform sampler2D hostDepth;
layout(binding = 1) uniform sampler2D hostNormal;
layout(binding = 2) uniform sampler2D hostEmission;
uniform ivec2 corner; // of the view's rectangle
uniform int originTop, depthType, depthMinusOne, normalType, viewSpace, emits;
uniform float hostNear, hostFar, nearOverFar; // planes, metres
layout(location = 0) out vec4 outNormal;
layout(location = 1) out vec4 outEmission;

const int kForward = 1, kLinear = 2;                                   // HostDepth
const int kUnorm = 1, kOctahedral = 2, kOctahedralUnorm = 3;           // HostNormals
const float kSilhouette = 0.5; // cosine: what faces away by more shows its back, by less is bent by smooth shading

/// Distance along the view direction, metres; 0: nothing is seen.
float distanceOf(float stored) {
  if (depthType == kLinear) return stored > 0.0 && !isinf(stored) ? stored : 0.0;
  float depth = depthMinusOne != 0 ? 0.5 * stored + 0.5 : stored;
  if (hostNear == 0.0) return depth > 0.0 ? viewDistanceFromDepth(camera, depth) : 0.0;
  float reversed = depthType == kForward ? 1.0 - depth : depth;
  if (!(reversed > 0.0)) return 0.0;
  if (camera.lens.w > 0.0) return hostFar - reversed * (hostFar - hostNear);
  return hostNear / (nearOverFar + reversed * (1.0 - nearOverFar));
}

vec3 normalOf(vec3 stored) {
  vec3 n = stored;
  if (normalType == kUnorm || normalType == kOctahedralUnorm) n = 2.0 * n - 1.0;
  if (normalType >= kOctahedral) n = unitFromOctahedral(n.xy);
  if (viewSpace != 0) n = mat3(camera.worldFromView) * n;
  return n;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 there = corner + ivec2(pixel.x, originTop != 0 ? int(camera.size.y) - 1 - pixel.y : pixel.y);
  outNormal = outEmission = vec4(0.0);
  gl_FragDepth = 0.0;
  float distance = distanceOf(texelFetch(hostDepth, there, 0).r);
  if (!(distance > 0.0)) return;
  float far = camera.lens.w, near = camera.lens.z;
  gl_FragDepth = clamp(far > 0.0 ? (far - distance) / (far - near) : near / distance, 1e-30, 1.0);

  vec3 towardsViewer = -normalize(mat3(camera.worldFromView) * viewDirectionFromPixel(camera, gl_FragCoord.xy));
  vec3 normal = normalOf(texelFetch(hostNormal, there, 0).xyz);
  float size = length(normal);
  normal = size > 0.0 && !isinf(size) ? normal / size : towardsViewer; // NaN too
  float facing = dot(normal, towardsViewer);
  if (facing < -kSilhouette)
    normal = -normal;
  else if (facing <= 0.0)
    normal = normalize(normal + (1e-3 - facing) * towardsViewer);
  outNormal = vec4(normal, 1.0);
  vec3 emission = emits != 0 ? texelFetch(hostEmission, there, 0).rgb : vec3(0.0);
  outEmission = vec4(mix(vec3(0.0), emission, greaterThan(emission, vec3(0.0))), 1.0); // of what is no number, 0
}
