// The points of a shot's picture that measurements watch, and truth at them.
#pragma once

#include "engine/scene/shot.h"
#include "gi/reference/path_tracer.h"
#include "gi/plan/settings.h"

namespace lambent {

/// The shot's own points first, then the cell centres of a grid; (u, v) in [0, 1], v down.
struct TrackedPixels {
  std::vector<vec2> points;
  size_t marked = 0; // the shot's own
};
TrackedPixels trackedPixels(const Shot& shot, int grid);

/// Indirect radiance of one tracked point and its standard error, per channel.
struct TrackedValue {
  vec3 radiance{0}, error{0};
};
/// Zero where the camera sees no surface.
TrackedValue trackedValue(const PixelSums& sums, const SurfaceHit& surface, uint32_t samples);

/// Throws InputError when receivers are to be glossy: values and their truth are those of Lambert surfaces.
void refuseGlossy(const Settings& settings);

} // namespace lambent
