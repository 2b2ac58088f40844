// Who places the virtual lights: the sequential Monte Carlo set, or one of the techniques that paper 1 compares it with
// (section 5.1). All fill the same VplSet, so that visibility, gathering and filtering are the same for each. The
// comparators place their whole set again in every frame; what keeps its place keeps its slot, its id and its map.
#pragma once

#include "gi/vpl/smc.h"

namespace lambent {

/// Places the set of this frame by `source`. Slots whose light now stands elsewhere are listed as moved. A set that
/// another source filled is given up first.
VplChanges placeVpls(VplSource source, VplSet& set, const VplUpdate& in, VplUpdateLog& log,
                     const std::function<void(int, int)>& progress = {});

/// Rays that look for places in a frame, for each slot, and the setting that says so.
struct CandidatesAsked {
  int perSlot;
  const char* setting;
};
CandidatesAsked candidatesAsked(const SmcSettings& smc, const VplSettings& vpl);

/// Instant radiosity (Keller 1997): photons from the lights leave a VPL at each of their first B hits. The sequence of
/// photons is the same in every frame, so a static scene gives the same set. Photons that leave the scene leave slots
/// empty.
VplChanges placeByPhotons(VplSet& set, const VplUpdate& in, VplUpdateLog& log);

/// Metropolis instant radiosity (Segovia et al. 2007) as paper 1 does it: `vpl.mirCandidates` paths per slot from the
/// camera, resampled in proportion to the light they bring to the image, independently in each frame. A camera that
/// sees nothing leaves the set as it is.
VplChanges placeByImagePower(VplSet& set, const VplUpdate& in, VplUpdateLog& log);

/// Temporally coherent adaptive sampling (Barák et al. 2013): each slot's Markov chain of `vpl.tcasIterations` steps
/// over the reflective shadow maps of the lights, towards what the image would receive if nothing were in the way. One
/// bounce only.
VplChanges placeByShadowMapChains(VplSet& set, const VplUpdate& in, VplUpdateLog& log);

/// Poisson samples over both sides of all surfaces that reflect, each for its share of their area (paper 4, 3.2). They
/// stay where they are as long as the same objects are there, and move with these.
VplChanges placeOverSurfaces(VplSet& set, const VplUpdate& in, VplUpdateLog& log);

/// What a comparator puts into a slot. Without power the slot is empty.
struct PlacedVpl {
  vec3 position{0}, normal{0, 1, 0}, geometricNormal{0, 1, 0}, albedo{0};
  vec3 power{0};         // radiance × area, W/sr along the normal: all that rendering sums up
  uint32_t instance = 0; // index into SceneView::instances

  PlacedVpl() = default;
  /// A diffuse reflector of `flux` (W) at a hit.
  PlacedVpl(const SurfaceHit& hit, const vec3& flux);
  bool alive() const { return maxComponent(power) > 0; }
};

/// Puts `placed` (one per slot) into the set. The areas are those of k nearest neighbours, as for smc, because the
/// gather blurs each VPL by its area; the radiance then follows from the power, so errors of the areas cancel.
VplChanges adoptVpls(VplSet& set, std::span<const PlacedVpl> placed, const VplUpdate& in, VplUpdateLog& log);

/// How often systematic resampling draws each index when `count` are drawn in proportion to `weights`; `u` in [0, 1)
/// places the comb. All zero if the weights are.
std::vector<uint32_t> systematicMultiplicities(std::span<const float> weights, uint32_t count, float u);

} // namespace lambent
