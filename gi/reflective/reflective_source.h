// Lights of reflective shadow maps (papers 2 and 3), drawn on the GPU.
#pragma once

#include "gi/contract/light_source.h"
#include "gi/reflective/reflective_maps.h"
#include "gi/sources/packed_lights.h"

#include <optional>

namespace lambent {

/// A grid over the maps (rsm), their smooth patches (isr), or trees over them (hisr).
enum class ReflectiveLights { Grid, Clusters, Trees };

class ReflectiveSource : public LightSource {
 public:
  ReflectiveSource(PassContext context, ReflectiveLights kind) : kind_(kind), mapPass_(context), lightPass_(context) {}

  VirtualLights run(const FrameWorld& in, const Needs& needs, FrameStats& stats) override;
  void forget() override { old_ = true; }

 private:
  ReflectiveLights kind_;
  ReflectiveMapPass mapPass_;
  ReflectiveLightPass lightPass_;
  ReflectiveMaps sheet_;
  std::optional<LightTrees> trees_;
  std::vector<VirtualLight> shown_;
  bool old_ = true; // frames passed without the maps
};

} // namespace lambent
