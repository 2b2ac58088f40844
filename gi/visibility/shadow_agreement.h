// How well paraboloid shadow maps tell what light of a virtual light reaches a pixel: the two makers against each
// other, and each against rays. Weighted by contribution (docs: visibility error).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

namespace lambent {

class ParaboloidMapPass;
class RayQuery;
struct CameraView;
struct ParaboloidMapInputs;
struct Settings;
struct VirtualLight;

struct ShadowAgreement {
  uint64_t pairs = 0; // (pixel, light) pairs that face each other
  double makers = 0;  // share of the unshadowed contribution where raster and ray-cast maps disagree
  double rasterAgainstRays = 0, castAgainstRays = 0; // the same of each maker's map against a ray per pair
};

/// Compares `slots` lights spread over the list, each at about `points` visible points of the camera.
ShadowAgreement measureShadowAgreement(ParaboloidMapPass& pass, const ParaboloidMapInputs& maps, const RayQuery& rays,
                                       const CameraView& camera, std::span<const VirtualLight> lights,
                                       const Settings& settings, int slots, int points,
                                       const std::function<void(int, int)>& progress);

} // namespace lambent
