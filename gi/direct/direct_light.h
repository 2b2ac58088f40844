// Direct light: punctual lights and the sky with shadow maps of their own, emissive surfaces as shadowed samples.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/light_on_surfaces.h"
#include "gi/contract/world.h"
#include "gi/direct/light_shadows.h"
#include "gi/lights/packed_lights.h"
#include "gi/visibility/paraboloid_maps.h"

namespace lambent {

struct DirectInputs {
  const World& world;
  const GBuffer& surfaces;
  const EffectPlan& plan;
  const ShadowSettings& shadow;
};

class DirectLight {
 public:
  explicit DirectLight(PassContext context);
  LightOnSurfaces run(const DirectInputs& in, FrameStats& stats);

 private:
  void fitReceivers(const DirectInputs& in, FrameStats& stats);

  PassContext context_;
  LightShadowPass shadows_;
  PackedLightBuffer emitters_;
  ParaboloidMapPass emitterMaps_;
  std::vector<MapPose> emitterPoses_; // as drawn
  Aabb receivers_;                    // everything the camera sees: what maps of suns and sky must cover
  gl::Sampler compare_;               // bilinear depth comparison for the emitters' maps
  LightTarget target_{"direct"};
};

} // namespace lambent
