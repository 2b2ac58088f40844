// Whether a sky would light anything of a scene that somebody looks at, and whether what shines in it does.
#pragma once

#include "engine/trace/ray_query.h"

namespace lambent {

/// Says whether paths from `eye` that surfaces reflect up to three times get out to the sky: false in a room without
/// openings, true under a balcony of an open court. The same for the same scene.
bool skyReaches(const RayQuery& rays, const vec3& eye);

/// Radiance that reaches what the camera sees from surfaces that shine, straight; luminance, mean over the picture and
/// over directions by their cosine. The same for the same scene.
float glowOnSeen(const RayQuery& rays, const CameraView& camera);

} // namespace lambent
