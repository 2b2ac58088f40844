// Reading the G-buffer. Units 0, 1 and 13 and uniform binding 0 belong to it.
// Variant MAPPED_NORMALS.
#include "shared/camera_block.h"

layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform sampler2D gbufferDepth;
layout(binding = 1) uniform sampler2D gbufferNormal;

#ifdef MAPPED_NORMALS
#include "shared/normal_map.h"
layout(binding = 13) uniform sampler2D gbufferMappedNormal;
#endif

/// The normal that light meets, by the material's normal map; `normal`, the G-buffer's, is that of places.
vec3 normalForLight(ivec2 pixel, vec3 normal) {
#ifdef MAPPED_NORMALS
  return texelFetch(gbufferMappedNormal, pixel, 0).xyz;
#else
  return normal;
#endif
}

/// Length of the mean of the normals that a pixel has (meanCosine); normalForLight is its direction.
float lengthForLight(ivec2 pixel) {
#ifdef MAPPED_NORMALS
  return texelFetch(gbufferMappedNormal, pixel, 0).w;
#else
  return 1.0;
#endif
}

/// World position of a pixel's surface; depth must not be 0.
vec3 positionFromDepth(ivec2 pixel, float depth) {
  return (camera.worldFromView * vec4(positionViewFromDepth(camera, vec2(pixel) + 0.5, depth), 1.0)).xyz;
}

/// Of a way from or to a light, which may stand on what it lights: never 0, so that its direction is a number.
float squaredLength(vec3 way) { return max(dot(way, way), 1e-20); }
