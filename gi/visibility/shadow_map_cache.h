// Shadow maps of virtual lights, whoever placed these: kept from frame to frame, drawn again where a light or an object
// moved.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/light_provider.h"
#include "gi/visibility/map_schedule.h"
#include "gi/visibility/paraboloid_maps.h"

namespace lambent {

struct ShadowMapInputs {
  const FrameWorld& frame; // its seed is that of the rays that look for moved objects
  const VirtualLights& lights;
  bool maps = true; // they have any
};

class ShadowMapCache {
 public:
  explicit ShadowMapCache(PassContext context) : pass_(context, StageId::VplMaps) {}

  /// Updates the lights' maps: of lights that may wait as far as `shadow.refresh` allows, of others at once.
  ShadowedLights update(const ShadowMapInputs& in, FrameStats& stats);

  /// Drops all maps: another scene follows.
  void forget() {
    schedule_.clear();
    maps_ = {};
    old_ = fresh_ = true;
  }
  /// Number of maps that still show where a moved object was, or are coarse.
  uint32_t waiting() const { return uint32_t(schedule_.waiting()); }
  /// Returns the maps of the last update; empty where its lights had none.
  const ParaboloidMaps& maps() const { return maps_; }

 private:
  std::vector<MapJob> inTurn(const ShadowMapInputs& in, FrameStats& stats);

  ParaboloidMapPass pass_;
  MapSchedule schedule_;
  ParaboloidMaps maps_;
  std::vector<MapPose> poses_; // by slot, as drawn
  bool old_ = false;           // lights were shown without maps
  bool fresh_ = true;          // no map was drawn of this scene
};

/// Jobs that bring maps up to date at once: whole where the light is new or moved, else the part that a box covers.
/// `before`: poses as drawn. A slot whose light is not alive needs none.
std::vector<MapJob> jobsAtOnce(std::span<const MapPose> poses, std::span<const MapPose> before,
                               std::span<const VirtualLight> lights, std::span<const Aabb> moved, bool all,
                               int resolution);

} // namespace lambent
