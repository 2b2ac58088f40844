// Which share of the area lights' light reaches the fragments of an image: patches of it, split where visibility
// changes. Paper 4, sections 3.1.1 to 3.1.4 (sub-fragment visibility tests, SFVT; gradient aware subdivision, GASS),
// and for comparison that of Nichols et al. 2010 by neighbourhoods.
#pragma once

#include "gi/direct/area_visibility.h"
#include "gi/plan/settings.h"

namespace lambent {

/// Fragments of one level, 2^level pixels wide, row by row over the padded image.
struct FragmentLevel {
  glm::ivec2 size{0};
  std::vector<uint8_t> smooth; // in: 1 where the patch is one surface, 0 where it is to be split or shows nothing
  std::vector<vec4> visible;   // out: share of the unshadowed light per channel; w: 1 where a fragment is, kBetween
                               // where it is large and others around it hold something else
};

inline constexpr float kBetween = 2;

struct FragmentCounts {
  uint64_t fragments = 0, dark = 0, extra = 0; // with extra samples; dark: of these, without any light
  RayCounts rays;
};

/// Finds which share of the lights is visible and fills `visible` of the levels, 0 to the coarsest. The result is the
/// same for any number of threads.
FragmentCounts shareVisible(const RayQuery& rays, const AreaLights& lights, const FrameSurfaces& surfaces,
                            const AreaSettings& settings, std::span<FragmentLevel> levels);

} // namespace lambent
