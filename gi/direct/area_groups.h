// Lights that may share rays. A share of the light of all (gi/direct/area_fragments.h) says little of a lamp that is
// outshone by others, least of all where these are hidden: such lamps have shares of their own.
#pragma once

#include "gi/direct/area_visibility.h"

namespace lambent {

/// The lights in groups: of those that a few rays from the image reach, each within a factor of 16 of the next in
/// what they bring to it; and of those that no ray reached, which may be seen by a few pixels all the same. `bands`:
/// the group of each light, those of the frame before where there is one: a light stays in its group until it is well
/// beyond it, so that a camera that moves makes none hop to and fro between two.
std::vector<AreaLights> groupsOf(const AreaLights& lights, const RayQuery& rays, const FrameSurfaces& surfaces,
                                 std::vector<int>& bands, RayCounts& counts);

} // namespace lambent
