// Light at points that no image shows: particles, things that are drawn forward. On the CPU, with a ray for every
// virtual light, so that nothing depends on what else is asked for.
#pragma once

#include "gi/contract/virtual_lights.h"
#include "gi/lighting/light_set.h"
#include "gi/plan/settings.h"

namespace lambent {

struct PointInputs {
  const SceneView& view;
  const RayQuery& rays;
  const LightSet& lights;                 // of the scene
  std::span<const VirtualLight> virtuals; // all of them
  const Settings& settings;               // as gathered (asGathered)
  uint32_t seed = 1;
};

/// Irradiance by virtual lights and, where the settings have them, near rays, W/m². Of points position, normal and
/// geometricNormal are looked at (world space, unit); those that are not valid get none.
std::vector<vec3> indirectAtPoints(const PointInputs& in, std::span<const SurfaceHit> points);
/// Irradiance by the scene's own lights, W/m².
std::vector<vec3> directAtPoints(const PointInputs& in, std::span<const SurfaceHit> points);

} // namespace lambent
