// A grid of cells over the scene, and what surfaces leave open between them. World space.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/contract/world.h"
#include "gi/plan/settings.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lambent {

/// `cells`³ cubes; the first one's corner lies on the lattice of whole cells.
struct VolumeGrid {
  int cells = 0;
  float cell = 0; // edge, metres
  ivec3 first{0}; // on the lattice

  bool operator==(const VolumeGrid&) const = default;
  vec3 corner() const { return vec3(first) * cell + offset; }
  vec3 centre(const ivec3& at) const { return (vec3(first + at) + 0.5f) * cell + offset; }
  bool holds(const ivec3& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < cells && at.y < cells && at.z < cells;
  }
  size_t index(const ivec3& at) const { return (size_t(at.z) * cells + at.y) * cells + at.x; }
  size_t size() const { return size_t(cells) * cells * cells; }

  vec3 offset{0}; // of the lattice, metres
};

/// Returns the grid that the settings ask for. With lpv.size it follows the camera; else it holds the scene, and stays
/// the same while that fits into `before` and fills half of it.
VolumeGrid volumeGrid(const VolumeSettings& settings, const SceneView& view, const VolumeGrid& before);

/// What every cell sees of its neighbourhood: the fuzzy occlusion volume (Kaplanyan and Dachsbacher 2010, section 4.2)
/// of paper 4, by rays instead of surfels splatted into harmonics, whose two bands stop three quarters of the light at
/// most. What geometry did not change near is kept, also where the grid goes on by whole cells.
class VolumeVisibility {
 public:
  /// Updates what cells see. Returns whether anything may have changed.
  bool update(const VolumeGrid& grid, const World& world, bool occlusion, RayCounts& counts);

  const VolumeGrid& grid() const { return grid_; }
  /// By cell: the share of light that gets from its centre's surroundings to those of the next one along x, y and z.
  /// 0 where the straight way between the centres is barred and so are the four ways around it: a wall, however thin
  /// and however it stands, not a pole.
  std::span<const vec4> open() const { return open_; }
  /// By cell: which of the 64 parts of the two cells' width around its centre that sees (volumePart).
  std::span<const glm::uvec2> sights() const { return sights_; }

 private:
  static constexpr int kTests = 5; // rays between neighbours, the first from centre to centre

  bool barred(const ivec3& at, int axis) const; // from centre to centre; true out of the grid
  void traceFaces(const std::vector<uint32_t>& stale, const RayQuery& rays, RayCounts& counts);
  void closeWalls();
  void traceSights(const RayQuery& rays, RayCounts& counts);
  bool nearWall(const ivec3& at) const;

  VolumeGrid grid_;
  bool occlusion_ = true;
  std::vector<std::array<uint8_t, 3>> blocked_; // bits of the tests towards x, y, z
  std::vector<uint8_t> sightsKnown_;
  std::vector<vec4> open_;
  std::vector<glm::uvec2> sights_;
};

} // namespace lambent
