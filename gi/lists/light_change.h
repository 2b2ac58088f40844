// How much the light of a tile changed since the frame before, told without the noise of a gather: the lights that stay
// say what they brought and bring, those that came and went how much is not known, and objects that moved which lights
// they may shade. As if nothing stood between: lights behind walls count.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/contract/virtual_lights.h"

#include <span>
#include <vector>

namespace lambent {

inline constexpr float kOtherLight = -1; // LightChangeInputs::before: another light was in the slot, or none

/// A sphere around what moved. World space, m.
struct MovedSphere {
  vec3 centre{0};
  float radius = 0;
};

struct LightChangeInputs {
  std::span<const VirtualLight> lights; // by slots
  std::span<const vec3> before;         // radiance a frame ago, W/(m² sr), by slots; x = kOtherLight: not known
  std::span<const MovedSphere> moved;   // of this frame and the last few
  std::span<const SurfaceHit> places;   // `perTile` of each tile: the first that is seen speaks for it
  int perTile = 1;
  float disk = 1; // GatherSettings::disk
};

struct LightChange {
  float share = 0;  // of the light that may have changed, 0 to 1
  float gained = 0; // what lights that stay gained, of the larger of before and now, -1 to 1
};

/// The change of each tile. Where nothing is known of the frame before, all may have changed.
std::vector<LightChange> lightChanges(const LightChangeInputs& in);

} // namespace lambent
