// The lobe of ggx.h over a piece of an area light, by linearly transformed cosines (Heitz, Dupuy, Hill and Neubelt
// 2016, "Real-time polygonal-light shading with linearly transformed cosines"): lobe times cosine is close to a clamped
// cosine under a linear map of directions, and the integral of a clamped cosine over a polygon is areaFormFactor. The
// maps are fitted by gi/lighting/area_lobe.cpp.
#ifndef LAMBENT_SHARED_AREA_LOBE_H
#define LAMBENT_SHARED_AREA_LOBE_H
#include "area_piece.h"
#include "ggx.h"
SHARED_BEGIN

/// An entry of the table. The lobe is linear in F0: F0 times that of F0 = 1, and 1 − F0 times Schlick's part, that of
/// F0 = 0, which leans towards the horizon. Each has a map of directions as inLobeSpace takes it.
struct AreaLobe {
  vec4 white;   // map for F0 = 1
  vec4 schlick; // map for F0 = 0
  vec4 share;   // of uniform light from above that is reflected; x: F0 = 1, y: F0 = 0
};

/// Entries: the root of roughness from that of kLeastRoughness to 1, and sqrt(1 − cosine) of the viewer's angle from 0
/// to 1.
const int kLobeRoughnesses = 20;
const int kLobeAngles = 24;

/// Where the entry for α² and a viewer's cosine lies, as coordinates of a texture with linear filter.
SHARED_INLINE vec2 lobePlace(float alpha2, float cosViewer) {
  float least = sqrt(kLeastRoughness), roughness = (sqrt(sqrt(sqrt(alpha2))) - least) / (1.0f - least);
  float angle = sqrt(max(1.0f - cosViewer, 0.0f));
  return vec2((clamp(roughness, 0.0f, 1.0f) * float(kLobeRoughnesses - 1) + 0.5f) / float(kLobeRoughnesses),
              (min(angle, 1.0f) * float(kLobeAngles - 1) + 0.5f) / float(kLobeAngles));
}

/// A map as the table holds it, of directions along the mirrored one and across it in the plane of the viewer: there it
/// changes little from view to view. `turn` 1: to that form, -1: back to what inLobeSpace takes.
SHARED_INLINE vec4 turnedMap(vec4 map, float cosViewer, float turn) {
  float sine = turn * sqrt(max(1.0f - cosViewer * cosViewer, 0.0f));
  return vec4(map.x * cosViewer + map.y * sine, map.y * cosViewer - map.x * sine, map.z * cosViewer + map.w * sine,
              map.w * cosViewer - map.z * sine);
}

/// An entry between those of the table, for a viewer.
SHARED_INLINE AreaLobe forViewer(AreaLobe entry, float cosViewer) {
  AreaLobe lobe;
  lobe.white = turnedMap(entry.white, cosViewer, -1.0f);
  lobe.schlick = turnedMap(entry.schlick, cosViewer, -1.0f);
  lobe.share = entry.share;
  return lobe;
}

/// The receiver's frame: z along the normal, the viewer in the plane of x and z. `x` and `y` are unit.
SHARED_INLINE void lobeFrame(Receiver r, SHARED_OUT(vec3) x, SHARED_OUT(vec3) y) {
  vec3 n = r.normal;
  vec3 along = r.towardsViewer - n * dot(n, r.towardsViewer);
  if (dot(along, along) < 1e-8f) along = abs(n.x) < 0.6f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
  along = along - n * dot(n, along);
  x = along / sqrt(dot(along, along));
  y = cross(n, x);
}

/// A piece in the space in which the lobe is a clamped cosine around z: the receiver at the origin, its frame (x, y,
/// normal) mapped by the matrix of rows (m.x, 0, m.y), (0, 1, 0), (m.z, 0, m.w), whose determinant is positive.
SHARED_INLINE AreaPiece inLobeSpace(AreaPiece piece, vec3 position, vec3 x, vec3 y, vec3 normal, vec4 m) {
  int corners = max(int(piece.corners[0].w), 1);
  AreaPiece mapped = piece;
  for (int i = 0; i < corners; ++i) {
    vec3 way = vec3(piece.corners[i]) - position;
    float along = dot(x, way), up = dot(normal, way);
    mapped.corners[i] = vec4(m.x * along + m.y * up, dot(y, way), m.z * along + m.w * up, piece.corners[i].w);
  }
  // Vectors of area go by the matrix of cofactors.
  vec3 front = vec3(piece.normalArea);
  float along = dot(x, front), up = dot(normal, front);
  vec3 area = piece.normalArea.w *
              vec3(m.w * along - m.z * up, (m.x * m.w - m.y * m.z) * dot(y, front), m.x * up - m.y * along);
  float size = max(sqrt(dot(area, area)), 1e-30f);
  mapped.normalArea = vec4(area / size, size);
  return mapped;
}

/// Factor of a mapped cosine that reflects `share` of uniform light from above: of it (1 + the cosine between z and the
/// mapped horizon's normal) / 2 lies there. Over π, for areaFormFactor has it in it.
SHARED_INLINE float lobeScale(float share, vec4 map) {
  return share * 0.318309886f / max(0.5f + 0.5f * map.x / sqrt(map.x * map.x + map.z * map.z), 0.25f);
}

/// Radiance towards the viewer per radiance of a piece, where nothing is between. `x`, `y`: lobeFrame.
SHARED_INLINE vec3 lobeReflection(AreaPiece piece, vec3 position, Receiver r, AreaLobe lobe, vec3 x, vec3 y) {
  vec3 up = vec3(0.0f, 0.0f, 1.0f), here = vec3(0.0f, 0.0f, 0.0f);
  float white = lobeScale(lobe.share.x, lobe.white) *
                areaFormFactor(inLobeSpace(piece, position, x, y, r.normal, lobe.white), here, up);
  float schlick = lobeScale(lobe.share.y, lobe.schlick) *
                  areaFormFactor(inLobeSpace(piece, position, x, y, r.normal, lobe.schlick), here, up);
  return r.specular * white + r.grazing * schlick;
}

SHARED_END
#endif
