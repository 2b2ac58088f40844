// Shadow maps of virtual lights, whoever placed these: kept from frame to frame, drawn again where a light or an object
// moved.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/world.h"
#include "gi/visibility/map_schedule.h"
#include "gi/visibility/paraboloid_maps.h"

namespace lambent {

struct ShadowMapInputs {
  const World& world;
  const VirtualLights& lights;
  const Settings& settings;
  uint32_t seed = 1; // of the rays that look for moved objects
};

class ShadowMapCache {
 public:
  explicit ShadowMapCache(PassContext context) : pass_(context, StageId::VplMaps) {}

  /// The lights with what their visibility setting asks for: maps brought up to date, or nothing. Lights that may wait
  /// have theirs redrawn as far as `shadow.refresh` goes, others at once.
  ShadowedLights see(const ShadowMapInputs& in, const EffectPlan& plan, FrameStats& stats);

  /// The scene is another.
  void forget() {
    schedule_.clear();
    maps_ = {};
    old_ = true;
  }
  /// Maps that show where something was.
  uint32_t waiting() const { return uint32_t(schedule_.waiting()); }
  /// Of the last `see`; empty where its lights had none.
  const ParaboloidMaps& maps() const { return maps_; }
  ParaboloidMapPass& pass() { return pass_; }

 private:
  std::vector<MapJob> inTurn(const ShadowMapInputs& in, const EffectPlan& plan, FrameStats& stats);

  ParaboloidMapPass pass_;
  MapSchedule schedule_;
  ParaboloidMaps maps_;
  std::vector<MapPose> poses_; // by slot, as drawn
  bool old_ = false;           // lights were shown without maps
};

/// Jobs that bring maps up to date at once: whole where the light is new or moved, else the part that a box covers.
/// `before`: poses as drawn. A slot whose light is not alive needs none.
std::vector<MapJob> jobsAtOnce(std::span<const MapPose> poses, std::span<const MapPose> before,
                               std::span<const VirtualLight> lights, std::span<const Aabb> moved, bool all,
                               int resolution);

} // namespace lambent
