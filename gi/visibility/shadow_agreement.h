// How well paraboloid shadow maps tell what light of a VPL reaches a pixel: the two makers against each other, and each
// against rays. Weighted by contribution (design/MEASURES: visibility error).
#pragma once

#include "gi/contract/passes.h"
#include "gi/vpl/smc.h"

namespace lambent {

struct ShadowAgreement {
  uint64_t pairs = 0; // (pixel, VPL) pairs that face each other
  double makers = 0;  // share of the unshadowed contribution where raster and ray-cast maps disagree
  double rasterAgainstRays = 0, castAgainstRays = 0; // the same of each maker's map against a ray per pair
};

/// `slots` VPLs spread over the set, each against about `points` visible points of the camera.
ShadowAgreement measureShadowAgreement(ParaboloidMapPass& pass, const ParaboloidMapInputs& maps, const RayQuery& rays,
                                       const CameraView& camera, const VplSet& set, const Settings& settings, int slots,
                                       int points, const std::function<void(int, int)>& progress);

} // namespace lambent
