// Lights that may share rays. A share of the light of all (gi/direct/area_fragments.h) says little of a lamp that is
// outshone by others, least of all where these are hidden: such lamps have shares of their own.
#pragma once

#include "gi/direct/area_visibility.h"

namespace lambent {

class AreaGroups {
 public:
  /// Returns the lights in groups: of those that a few rays from the image reach, by what they bring to it, each group
  /// within a factor of 16; and of those that no ray reached, which may be seen by a few pixels all the same. A light
  /// stays in its group of the frame before until it is a factor of two beyond it (so that one holds a factor of 64 at
  /// most): a camera that moves makes none hop to and fro between two.
  std::vector<AreaLights> of(const AreaLights& lights, const RayQuery& rays, const FrameSurfaces& surfaces,
                             RayCounts& counts);
  /// Call it where lights are others than before, not where they moved or shine otherwise.
  void forget() { bands_.clear(); }
  /// Group of each light by brightness, 0 the brightest, also of one that no ray reached since; −1: none yet.
  std::span<const int> bands() const { return bands_; }

 private:
  std::vector<int> bands_;
  double scale_ = 0; // what the brightest of them begins at
};

} // namespace lambent
