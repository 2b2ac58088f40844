// Whether a sky would light anything of a scene that somebody looks at.
#pragma once

#include "engine/trace/ray_query.h"

namespace lambent {

/// Says whether paths from `eye` that surfaces reflect up to three times get out to the sky: false in a room without
/// openings, true under a balcony of an open court. The same for the same scene.
bool skyReaches(const RayQuery& rays, const vec3& eye);

} // namespace lambent
