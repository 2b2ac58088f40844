// Cut-out triangles one behind the other: every ray through them tries each, whatever traces it.
#pragma once

#include "engine/scene/scene.h"

namespace lambent {

/// Layers that a line passes in the mean, and where it passes many.
struct SeeThrough {
  float layers = 0;
  vec3 place{0}; // world space
};

/// Of lines across alpha-masked triangles that are drawn at random, as the scene stands: how many such triangles each
/// passes where they are cut out, before it meets one where it is not. 64 lines, fewer (down to 4) where more than
/// 262 144 triangles are masked. May stop to count where it has `enough`.
SeeThrough seeThrough(const Scene& scene, float enough);

} // namespace lambent
