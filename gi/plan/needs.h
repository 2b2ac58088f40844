// What a technique asks of a frame, and how its light comes to be. The plan, presets, the governor and the tools read
// this in place of the technique's name.
#pragma once

#include "gi/plan/axes.h"

#include <cstdint>
#include <string>

namespace lambent {

struct Settings;

struct Needs {
  // What the provider asks of the world.
  LightSupply lights = LightSupply::None;
  bool bounces = false;          // follows smc.bounces; else light is reflected once
  bool textures = false;         // looks textures up where its rays meet surfaces; else it takes their mean colour
  bool previousSurfaces = false; // depth and normals of the frame before (Frame::previous)

  // How its virtual lights are used.
  bool anyView = false;     // they are the same wherever the camera is
  bool maps = false;        // they have shadow maps
  bool tree = false;        // clusters of all sizes that the gather chooses from, not a list
  bool lightsOnGpu = false; // the gather reads them there
  bool lightsOnCpu = false; // the gather, or whoever makes their maps, reads them there

  // How pixels get their light.
  bool subsets = false;    // neighbouring pixels gather different lights, which history and filter mix
  bool lists = false;      // they are chosen for each tile (gi/lists)
  bool nearRays = false;   // pixels cast random rays for what bounds take from near lights (gather.near)
  bool stored = false;     // light is kept in a store over the scene that outlives frames
  bool freeGather = false; // visibility and gather are anybody's choice: presets, the governor, a person
  bool rayPerPair = false; // a ray for every pixel and light: seconds per frame

  bool sampled() const {
    return lights == LightSupply::Kept || lights == LightSupply::Fixed || lights == LightSupply::PerFrame;
  }
  bool reflective() const { return lights == LightSupply::Reflective; }
  /// Says whether its lights live from frame to frame.
  bool persistent() const { return lights == LightSupply::Kept || lights == LightSupply::Fixed; }
};

/// How far a provider is: what its next run would bring that no frame shows yet.
struct ProviderStatus {
  bool settled = false;      // no better virtual lights are in reach (gi/vpl/settling.h)
  bool lightArrived = false; // they were updated next to the last frame, which does not show them
  uint32_t mapsWaiting = 0;  // maps that show where a moved object was, or are coarse
  int averaged = 0;          // frames in the mean since anything last changed
  std::string pending = {};  // why another frame of the same world would differ; empty: it has converged
};

/// Needs of a technique that is composed of the four axes.
Needs needsOf(const Axes& axes);
/// Needs of the technique that the settings choose.
Needs needsOf(const Settings& settings);
/// The settings as the stages of a frame take them: gather.disk is widened by gather.nearDisk where near rays are cast.
Settings asGathered(Settings settings);

} // namespace lambent
