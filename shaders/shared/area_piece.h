// A piece of an area light, and the irradiance that it brings where nothing is between: element of a uniform block,
// std140.
#ifndef LAMBENT_SHARED_AREA_PIECE_H
#define LAMBENT_SHARED_AREA_PIECE_H
#include "interop.h"
SHARED_BEGIN

struct AreaPiece {
  vec4 corners[4];    // xyz: world, counter-clockwise seen from the front; w of the first: how many, 3 or 4 (convex and
                      // plane); 0: a disk around the first
  vec4 normalArea;    // unit, to the front; m²
  vec4 radianceSides; // W/(m² sr); w: 1 = emits on both sides
};

const int kPiecesPerBlock = 128; // 12 KiB

/// Of the edge between two directions: cross(a, b) · angle / sin(angle).
SHARED_INLINE vec3 edgeIntegral(vec3 a, vec3 b) {
  vec3 c = cross(a, b);
  float sine = length(c), cosine = dot(a, b);
  return c * (sine > max(1e-4f * cosine, 1e-7f) ? atan(sine, cosine) / sine : 1.0f);
}

/// As areaFormFactor, of a piece that is a disk: E = L·a·cosx·cosy/(r² + a/π).
SHARED_INLINE float diskFormFactor(AreaPiece disk, vec3 position, vec3 normal) {
  vec3 way = vec3(disk.corners[0]) - position;
  float distance2 = max(dot(way, way), 1e-20f);
  float cosine = max(dot(normal, way), 0.0f), cosineLight = -dot(vec3(disk.normalArea), way);
  if (cosineLight < 0.0f) cosineLight = disk.radianceSides.w == 0.0f ? 0.0f : -cosineLight;
  return cosine * cosineLight * disk.normalArea.w / (distance2 * (distance2 + disk.normalArea.w * 0.318309886f));
}

/// Form factor times π (W/m² per W/(m² sr)) of a piece that emits towards a receiver at `position` with unit `normal`;
/// what lies below the receiver's horizon does not count. Lambert's formula for polygons (within 1e-3 of the value, and
/// within 1e-6 where they fill the sky); a polygon whose sides are less than a thirtieth of its distance counts as a
/// point at its centre (within 0.2 %). Disks: diskFormFactor.
SHARED_INLINE float areaFormFactor(AreaPiece piece, vec3 position, vec3 normal) {
  int count = int(piece.corners[0].w);
  if (count == 0) return diskFormFactor(piece, position, normal);
  vec3 corner = vec3(piece.corners[0]) - position;
  vec3 front = vec3(piece.normalArea);
  float area = piece.normalArea.w;
  float side = dot(front, corner); // < 0: the receiver is in front
  if (side >= 0.0f) {
    if (piece.radianceSides.w == 0.0f || side == 0.0f) return 0.0f;
  }
  vec3 centre = corner + vec3(piece.corners[1]) + vec3(piece.corners[2]) - 2.0f * position;
  centre = count == 4 ? 0.25f * (centre + vec3(piece.corners[3]) - position) : centre * (1.0f / 3.0f);
  float distance2 = max(dot(centre, centre), 1e-20f);
  vec3 across = vec3(piece.corners[2] - piece.corners[0]);
  vec3 other = count == 4 ? vec3(piece.corners[3] - piece.corners[1]) : vec3(piece.corners[1] - piece.corners[0]);
  if (max(dot(across, across), dot(other, other)) < distance2 * 2e-3f) {
    float inverse = 1.0f / sqrt(distance2);
    float cosine = dot(normal, centre) * inverse, cosineLight = abs(dot(front, centre)) * inverse;
    return max(cosine, 0.0f) * area * cosineLight / distance2;
  }
  // Clipped at the horizon: edges that cross it end there, and one more runs along it.
  vec3 sum = vec3(0.0f, 0.0f, 0.0f), first = vec3(0.0f, 0.0f, 0.0f), last = vec3(0.0f, 0.0f, 0.0f);
  vec3 before = count == 4 ? vec3(piece.corners[3]) - position : vec3(piece.corners[2]) - position;
  float heightBefore = dot(normal, before);
  bool any = false;
  for (int i = 0; i < count; ++i) {
    vec3 here = vec3(piece.corners[i]) - position;
    float height = dot(normal, here);
    if ((height > 0.0f) != (heightBefore > 0.0f)) {
      vec3 crossing = before + (here - before) * (heightBefore / (heightBefore - height));
      crossing = crossing / max(sqrt(dot(crossing, crossing)), 1e-20f);
      if (any)
        sum += edgeIntegral(last, crossing);
      else
        first = crossing;
      last = crossing;
      any = true;
    }
    if (height > 0.0f) {
      vec3 direction = here / max(sqrt(dot(here, here)), 1e-20f);
      if (any)
        sum += edgeIntegral(last, direction);
      else
        first = direction;
      last = direction;
      any = true;
    }
    before = here;
    heightBefore = height;
  }
  if (!any) return 0.0f;
  sum += edgeIntegral(last, first);
  return max(0.5f * abs(dot(normal, sum)), 0.0f);
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::AreaPiece) == 96);
#endif
#endif
