// Whether a sky would light anything of a scene that somebody looks at, and whether what shines in it does.
#pragma once

#include "engine/trace/ray_query.h"

namespace lambent {

/// Says whether paths from `eye` that surfaces reflect up to three times get out to the sky: false in a room without
/// openings, true under a balcony of an open court. The same for the same scene.
bool skyReaches(const RayQuery& rays, const vec3& eye);

/// What shines, luminances of radiance in the mean over the surfaces of the picture.
struct Glow {
  float shown = 0;   // of these surfaces themselves
  float reaches = 0; // them from others, straight; mean over directions by their cosine
};
/// The same for the same scene.
Glow glowOnSeen(const RayQuery& rays, const CameraView& camera);

/// Returns the share of what lies before a camera that it looks through, backs that are hidden; 0: nothing lies there.
float shareLookedThrough(const RayQuery& rays, const CameraView& camera);

} // namespace lambent
