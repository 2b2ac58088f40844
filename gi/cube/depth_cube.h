// One layered depth cube: what rays along the three axes meet in it (paper 5, section 3). The paper fills its images
// with what hemicubes see, so that layers come in the order of lights; filled from the axes they depend on geometry
// alone, and a moved object changes the columns that it touches and no other. World space, metres.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/lighting/dirty_region.h"

namespace lambent {

/// A piece of a surface, one side of it, about as large as a texel. Its plane: dot(normal, p - position) = 0.
struct CubeEntry {
  vec3 position{0};        // on the surface, as near to the texel's middle as it reaches
  vec3 normal{0};          // geometric, unit
  vec3 shading{0};         // unit
  uint32_t neighbours = 0; // bit k: it sees the entry that carries its surface on in column neighbour k
  bool operator==(const CubeEntry&) const = default;
};

/// Steps in an image's two directions to neighbour k.
inline constexpr int kCubeNeighbours[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};

/// Says whether an entry is the surface at a place with this normal, `within` metres (paper 5, section 3.1).
bool matches(const CubeEntry& entry, const vec3& position, const vec3& normal, float within);
/// Images that hold a surface of this normal: where two axes are nearly as near, both. Bit a: axis a.
int axesOf(const vec3& normal);

/// Where a cube lies, and how its columns are counted. Images of resolution × resolution texels along x, y and z. A
/// column, the texel (u, v) of an image, looks along its axis; u runs along the next axis, v along the one after.
struct CubeGrid {
  vec3 corner{0};
  float texel = 0; // metres
  int resolution = 0;

  /// Makes a grid over a box of this edge and a texel around it: rays start outside of it, and pixels at its border
  /// find light around them.
  static CubeGrid over(const vec3& lo, float edge, int resolution);
  size_t columns() const { return 3 * size_t(resolution) * size_t(resolution); }
  /// Columns lie in blocks of 8×8: neighbours in space mostly are in memory.
  size_t column(int axis, int u, int v) const {
    const size_t blocks = size_t(resolution) / 8;
    return ((size_t(axis) * blocks + size_t(v) / 8) * blocks + size_t(u) / 8) * 64 + size_t(v % 8) * 8 + size_t(u % 8);
  }
  /// Inverse of column().
  struct Place {
    int axis, u, v;
  };
  Place placeOf(size_t column) const;
  /// Point of a column on the near side; `within` the texel, 0..1.
  vec3 pointOf(const Place& at, vec2 within) const;
  float edge() const { return float(resolution) * texel; }
  Aabb box() const { return {corner, corner + edge()}; }
  bool operator==(const CubeGrid&) const = default;
};

/// A cube with what lies in it.
struct DepthCube {
  CubeGrid grid;
  std::vector<uint32_t> firsts; // entries of column c are [firsts[c], firsts[c + 1])
  std::vector<CubeEntry> entries = {};
  uint32_t cut = 0; // columns of which a ray met 256 surfaces and there were more: of those that were cast

  /// Casts all columns.
  static DepthCube cast(const CubeGrid& grid, const RayQuery& rays, RayCounts& counts);
  /// Casts the columns that `moved` touches again.
  void refresh(const DirtyRegion& moved, const RayQuery& rays, RayCounts& counts);
  /// Share of the entries whose surface does not go on in all four directions, 0..1: edges, and all that is about as
  /// small as a texel.
  float atEdges() const;

 private:
  void castAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts);
  void linkAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts);
};

} // namespace lambent
