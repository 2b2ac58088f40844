// Lights of reflective shadow maps (papers 2 and 3), drawn on the GPU.
#pragma once

#include "gi/sources/light_source.h"
#include "gi/sources/packed_lights.h"
#include "gi/reflective/reflective_maps.h"

#include <optional>

namespace lambent {

class ReflectiveSource : public LightSource {
 public:
  explicit ReflectiveSource(PassContext context) : mapPass_(context), lightPass_(context) {}

  VirtualLights run(const SourceInputs& in, FrameStats& stats) override;
  void forget() override { old_ = true; }

 private:
  ReflectiveMapPass mapPass_;
  ReflectiveLightPass lightPass_;
  ReflectiveMaps sheet_;
  std::optional<LightTrees> trees_;
  std::vector<VirtualLight> shown_;
  bool old_ = true; // frames passed without the maps
};

} // namespace lambent
