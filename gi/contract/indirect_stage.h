// What gives indirect light on surfaces: a gather of virtual lights, or a stage that has none.
#pragma once

#include "gi/contract/surface_lighting.h"
#include "gi/contract/patches.h"
#include "gi/contract/virtual_lights.h"
#include "gi/contract/world.h"
#include "gi/plan/settings.h"

#include <functional>

namespace lambent {

struct FrameStats; // gi/contract/figures.h

struct IndirectInputs {
  const World& world;
  const GBuffer& surfaces;
  Patches& patches; // of the surfaces
  ShadowedLights seen;  // without slots for a technique that has no virtual lights
  const Settings& settings;
  int bounces = 1; // that the virtual lights hold, themselves included
  uint32_t seed = 1;
  uint32_t picture = 0;  // of those that are averaged: each takes other rays, and pixels another part of the lights
  bool averaged = false; // there are such pictures
  bool changes = false;  // light does; means are short then
  bool stands = false;   // neither light nor camera changes, and means follow no change before
  bool stores = true;    // what outlives pictures follows the lights; else it stays as it is
  uint32_t most = ~0u;   // lights that are put into it at once: there is no light before all are
  std::function<void(int, int)> progress = {}; // of what takes long: done and total; may be empty
};

class IndirectStage {
 public:
  virtual ~IndirectStage() = default;
  /// Irradiance at the surfaces, valid until the next run. Adds its rays and counts to the figures.
  virtual SurfaceLighting run(const IndirectInputs& in, FrameStats& stats) = 0;
};

} // namespace lambent
