// Triangles in one place: every ray there meets them all, whatever traces it.
#pragma once

#include "engine/scene/scene.h"

#include <optional>

namespace lambent {

/// A place in world space that lies on more than `most` triangles of the scene as it stands, or within 1 % of a
/// triangle's height of it. Looks at the middles of 1024 triangles that are drawn at random, and wants two of them:
/// nearly always found where one triangle in 200 lies so, seldom where fewer than one in 1000 do.
std::optional<vec3> crowdedPlace(const Scene& scene, int most);

} // namespace lambent
