// Surfaces of a scene in one layered depth cube, or in a tree of them (the further work of paper 5): a cube is given up
// for eight of half its edge and as many texels while more of what it holds is edges than `cube.split`, as deep as
// `cube.levels` says. Floors and walls then keep wide texels, and what is small or cluttered gets narrow ones. The tree
// depends on geometry alone. World space, metres.
#pragma once

#include "gi/cube/depth_cube.h"
#include "gi/plan/settings.h"
#include "shaders/shared/layered_cube.h"

namespace lambent {

class CubeSurfaces {
 public:
  bool empty() const { return nodes_.empty(); }
  /// Casts all columns. Throws RunError where they take more than so many bytes.
  void build(const Aabb& boundsWorld, const CubeSettings& settings, const RayQuery& rays, RayCounts& counts,
             size_t memory = ~size_t(0));
  /// Casts what `moved` touches; the result is what build() would make. Returns for each entry its number before, kNone
  /// where it is new. Throws as build().
  std::vector<uint32_t> update(const DirtyRegion& moved, const RayQuery& rays, RayCounts& counts,
                               size_t memory = ~size_t(0));
  /// Says whether the box holds the scene, and not much more.
  bool holds(const Aabb& boundsWorld) const;

  float texel() const { return edge_ / float(resolution_ - 2); } // metres, the widest
  /// The tree, as pixels descend it: the root, then eight children side by side wherever there are any.
  std::span<const CubeNode> nodes() const { return nodes_; }
  /// The cubes that are its leaves.
  std::span<const CubeGrid> cubes() const { return cubes_; }
  /// Columns of cube i are columns() · i and on, in the order of CubeGrid::column.
  size_t columns() const { return 3 * size_t(resolution_) * size_t(resolution_); }
  /// Entries of column c are [firsts()[c], firsts()[c + 1]).
  std::span<const uint32_t> firsts() const { return firsts_; }
  std::span<const CubeEntry> entries() const { return entries_; }
  /// Columns that hold more surfaces than were found, at most: those that were cast again count again.
  uint32_t columnsCut() const { return cut_; }

 private:
  friend struct CubeFile; // gi/cube/cube_file.cpp
  struct Growth;          // of a tree, next to the one before

  DepthCube cubeOf(uint32_t index) const;
  Growth grow(const DirtyRegion* moved, const RayQuery& rays, RayCounts& counts, size_t memory) const;
  void adopt(Growth& growth);

  vec3 lo_{0};
  float edge_ = 0; // of the box
  int resolution_ = 0, levels_ = 0;
  float split_ = 0;
  uint32_t cut_ = 0;
  std::vector<CubeNode> nodes_;
  std::vector<CubeGrid> cubes_;
  std::vector<uint32_t> firsts_;
  std::vector<CubeEntry> entries_;
};

} // namespace lambent
