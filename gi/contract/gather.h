// What gives light of virtual lights on surfaces: the part of a composed technique between lights and reconstruction.
#pragma once

#include "gi/contract/light_lists.h"
#include "gi/contract/light_provider.h"

namespace lambent {

struct GatherInputs {
  const Frame& frame;
  ShadowedLights lights;
  const LightLists* lists = nullptr; // which lights a pixel gathers; null: all, or those of its class
  uint32_t sample = 0;   // of those that are averaged: each takes other rays, and pixels another part of the lights
  bool averaged = false; // there are such samples
  bool changes = false;  // light does; means are short then
  float rest = 0;     // 1: neither light nor camera changes, and means follow no change before; on the way there, less
  bool stores = true; // what outlives frames follows the lights; else it stays as it is
};

class Gather {
 public:
  virtual ~Gather() = default;
  /// Computes irradiance at the surfaces, W/m², valid until the next run. Adds its rays and counts to the figures.
  virtual SurfaceLighting run(const GatherInputs& in, FrameStats& stats) = 0;
};

} // namespace lambent
