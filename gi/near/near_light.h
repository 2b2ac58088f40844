// Light that the bounded geometry term takes away, given back.
#pragma once

#include "gi/contract/virtual_lights.h"
#include "gi/lighting/light_set.h"
#include "gi/near/near_memory.h"
#include "gi/plan/settings.h"
#include "gi/vpl/smc.h"

namespace lambent {

struct NearLightInputs {
  const SceneView& view;
  const RayQuery& rays;
  const LightSet& lights;                 // of the scene
  std::span<const VirtualLight> virtuals; // that were gathered, bounded as `gather` says
  const GatherSettings& gather;
  int casts = 8;        // rays, as GatherSettings::near
  int bounces = 1;      // of the virtual lights: SmcSettings::bounces
  bool subsets = false; // interleaved: the pixels of 4×4 share the rays out, in other ways in each frame
  bool glossy = false;
  bool normalMaps = false;
  uint32_t seed = 1;
  uint32_t frame = 0;           // which of those that are averaged
  int frames = 1;               // that are; 1: blocks of pixels are mixed
  NearMemory* memory = nullptr; // of a view in motion: what it says of the frame before is used, and replaced
};

/// How many times GatherSettings::near is cast in a frame. `lists`: of lights that were chosen for tiles; `averaged`:
/// over frames; `changes`: light does.
int nearTimes(bool lists, bool averaged, bool changes);

/// Near light at pixel centres of the view's camera, row by row from the top.
struct NearLight {
  std::vector<vec3> irradiance;
  std::vector<vec3> glossy; // as GlossyGather::radiance; empty where not asked for
};

/// Traces what bounds take from near lights. Together with the virtual lights it gives what these would bring without
/// bounds if there were as many of them as the surface has points. Without bias where nearLimit is 0, as far as a
/// surface lies in the cell of the nearest light on its side.
NearLight traceNearLight(const NearLightInputs& in, RayCounts& counts);

/// Traces irradiance at surfaces that do not depend on the view, `casts` rays from each. The view is not looked at.
std::vector<vec3> traceNearLightAt(std::span<const SurfaceHit> surfaces, const NearLightInputs& in, RayCounts& counts);

} // namespace lambent
