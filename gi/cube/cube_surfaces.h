// Surfaces in the layered depth cube: what rays along the three axes meet (paper 5, section 3). The paper fills its
// images with what hemicubes see, so that layers come in the order of lights; filled from the axes they depend on
// geometry alone, and a moved object changes the columns that it touches and no other.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/plan/settings.h"
#include "gi/vpl/disturbance.h"

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

/// Images of resolution × resolution texels along x, y and z; the box is a cube. A column, the texel (u, v) of an
/// image, looks along its axis; u runs along the next axis, v along the one after.
class CubeSurfaces {
 public:
  bool empty() const { return resolution_ == 0; }
  /// Casts all columns.
  void build(const Aabb& boundsWorld, const CubeSettings& settings, const RayQuery& rays, RayCounts& counts);
  /// Casts columns that `moved` touches. Gives by entry its number before, kNone where it is new.
  std::vector<uint32_t> update(const Disturbance& moved, const RayQuery& rays, RayCounts& counts);
  /// Whether the box holds the scene, and not much more.
  bool holds(const Aabb& boundsWorld) const;

  int resolution() const { return resolution_; }
  vec3 corner() const { return corner_; }
  float texel() const { return texel_; } // metres
  size_t columns() const { return first_.size() - 1; }
  /// Columns lie in blocks of 8×8: neighbours in space mostly are in memory.
  size_t column(int axis, int u, int v) const {
    const size_t blocks = size_t(resolution_) / 8;
    return ((size_t(axis) * blocks + size_t(v) / 8) * blocks + size_t(u) / 8) * 64 + size_t(v % 8) * 8 + size_t(u % 8);
  }
  /// Its inverse.
  struct Place {
    int axis, u, v;
  };
  Place placeOf(size_t column) const;
  /// Entries of column c are [firsts()[c], firsts()[c + 1]).
  std::span<const uint32_t> firsts() const { return first_; }
  std::span<const CubeEntry> entries() const { return entries_; }

  /// Whether an entry is the surface at a place with this normal (paper 5, section 3.1), `within` metres.
  static bool matches(const CubeEntry& entry, const vec3& position, const vec3& normal, float within);
  /// Images that hold a surface of this normal: where two axes are nearly as near, both. Bit a: axis a.
  static int axesOf(const vec3& normal);

 private:
  friend struct CubeFile;                           // gi/cube/cube_file.cpp
  vec3 pointOf(const Place& at, vec2 within) const; // on the box's near side; `within` the texel, 0..1
  std::vector<CubeEntry> cast(const Place& at, const RayQuery& rays, RayCounts& counts) const;
  void castAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts);
  void linkAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts);

  vec3 corner_{0};
  float texel_ = 0;
  int resolution_ = 0;
  std::vector<uint32_t> first_;
  std::vector<CubeEntry> entries_;
};

} // namespace lambent
