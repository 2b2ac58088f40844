// What is drawn into paraboloid shadow maps: where a light stands, and which of its texels are redrawn.
#pragma once

#include "engine/trace/ray_query.h"

#include <cstdint>

namespace lambent {

/// Where a light stands. World space; the map covers the hemisphere around `normal`.
struct MapPose {
  vec3 position{0};              // on the surface
  vec3 normal{0, 1, 0};          // shading normal, unit
  vec3 geometricNormal{0, 1, 0}; // unit; the map's origin lies off the surface on this side
  float rayEpsilon = 1e-4f;      // of the ray query: how far
  vec3 origin() const { return offsetPoint(position, geometricNormal, rayEpsilon); }
  bool operator==(const MapPose&) const = default;
};

/// Texels [x0, x1) × [y0, y1) of a map.
struct TexelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool operator==(const TexelRect&) const = default;
  static TexelRect whole(int resolution) { return {0, 0, resolution, resolution}; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  int area() const { return empty() ? 0 : (x1 - x0) * (y1 - y0); }
  /// Grows to hold `o` too.
  void add(const TexelRect& o) {
    if (o.empty()) return;
    if (empty()) {
      *this = o;
      return;
    }
    x0 = x0 < o.x0 ? x0 : o.x0;
    y0 = y0 < o.y0 ? y0 : o.y0;
    x1 = x1 > o.x1 ? x1 : o.x1;
    y1 = y1 > o.y1 ? y1 : o.y1;
  }
};

/// Texels of the map of one slot that are redrawn.
struct MapJob {
  uint32_t slot = 0;
  TexelRect texels;
  int step = 1; // 2 or 4: of so many texels and rows only one is traced, and those between follow from them
};

/// Number of texels that are traced for a rectangle.
inline int64_t texelsTraced(const TexelRect& t, int step) {
  return t.empty() ? 0 : int64_t((t.x1 - t.x0 + step - 1) / step) * ((t.y1 - t.y0 + step - 1) / step);
}

} // namespace lambent
