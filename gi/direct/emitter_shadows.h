// Emissive surfaces as shadowed samples, as the direct pass reads them.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/world.h"
#include "gi/direct/light_shadows.h"
#include "gi/visibility/paraboloid_maps.h"

namespace lambent {

class EmitterShadowPass {
 public:
  explicit EmitterShadowPass(PassContext context) : context_(context), maps_(context, StageId::EmitterMaps) {}
  /// Returns about `samples` samples of all emitters together. Draws only maps whose sample or casters changed.
  std::vector<LightBlock> run(const World& world, const ShadowSettings& shadow, int samples, FrameStats& stats);
  /// Drops the maps. Call it while there are no samples: changes of what they see are then not reported.
  void forget() { poses_.clear(); }
  uint32_t samples() const { return uint32_t(poses_.size()); } // in the last run

 private:
  PassContext context_;
  ParaboloidMapPass maps_;
  std::vector<MapPose> poses_; // as drawn
  std::vector<LightRecords> blocks_;
  gl::Ring changedLights_{"emitters/changed lights"};
};

} // namespace lambent
