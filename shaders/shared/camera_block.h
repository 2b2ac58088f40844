// The camera as the passes read it: uniform block, std140.
#pragma once
#include "interop.h"
SHARED_BEGIN

struct CameraBlock {
  mat4 clipFromWorld;
  mat4 worldFromView;
  // Perspective: x, y = tangent of half the field of view; z = near plane, metres; w = 0.
  // Orthographic: x, y = half width and height, metres; z = near plane; w = far plane, metres.
  vec4 lens;
  vec4 size; // x, y = width and height, pixels; z, w = their inverses
  // A place read at distance d along the view direction is off by up to x + y d + z d² metres, by how its depth is stored.
  vec4 depthError;
};

/// Distance along the view direction, metres, of reversed depth in (0, 1].
SHARED_INLINE float viewDistanceFromDepth(CameraBlock c, float depth) {
  return c.lens.w > 0.0f ? c.lens.w - depth * (c.lens.w - c.lens.z) : c.lens.z / depth;
}

/// View-space position of the point at `pixel` (GL window coordinates, centres at .5).
SHARED_INLINE vec3 positionViewFromDepth(CameraBlock c, vec2 pixel, float depth) {
  float distance = viewDistanceFromDepth(c, depth);
  vec2 ndc = pixel * vec2(c.size.z, c.size.w) * 2.0f - vec2(1.0f, 1.0f);
  vec2 xy = ndc * vec2(c.lens.x, c.lens.y) * (c.lens.w > 0.0f ? 1.0f : distance);
  return vec3(xy.x, xy.y, -distance);
}

/// How far off its surface, metres, a place of the image may lie: GPUs round the corners of triangles to 1/256 of a pixel,
/// and some interpolate depth between what they rounded; a host's textures round it too. Rays begin so far above the place,
/// along its normal.
SHARED_INLINE float placeSlack(CameraBlock c, float distance) {
  float ofCorners = c.lens.y * c.size.w * (c.lens.w > 0.0f ? 1.0f : distance) / 128.0f;
  return ofCorners + c.depthError.x + distance * (c.depthError.y + distance * c.depthError.z);
}

/// View-space direction from the camera through `pixel` (as above), not of unit length.
SHARED_INLINE vec3 viewDirectionFromPixel(CameraBlock c, vec2 pixel) {
  vec2 ndc = pixel * vec2(c.size.z, c.size.w) * 2.0f - vec2(1.0f, 1.0f);
  return c.lens.w > 0.0f ? vec3(0.0f, 0.0f, -1.0f) : vec3(ndc.x * c.lens.x, ndc.y * c.lens.y, -1.0f);
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::CameraBlock) == 176);
#endif
