// What a frame made: light on surfaces, the surfaces, and what led to them, for viewers, hosts and tests.
#pragma once

#include "engine/view/sky.h"
#include "gi/contract/light_provider.h"

#include <optional>

namespace lambent {

/// What a frame made. Valid until the next run; textures are null where a stage did not run.
struct FrameOutputs {
  GBuffer surfaces;
  SurfaceLighting direct, indirect;
  ProviderInside inside;               // of the technique
  std::optional<PatchPyramid> patches; // where somebody asked for them
  Sky sky;
  float farDistance = 1; // metres; the scene's size, with room to grow
};

} // namespace lambent
