// A provider of light: what a technique is at run time. It takes a frame and gives light on its surfaces. Indirect
// light by virtual lights (gi/frame/composed_technique.h), direct light (gi/direct), and whatever a technique brings of
// its own are providers of the same kind; what each asks of a frame stands in its row (gi/plan/needs.h).
#pragma once

#include "gi/contract/patches.h"
#include "gi/contract/surface_lighting.h"
#include "gi/contract/virtual_lights.h"
#include "gi/contract/world.h"
#include "gi/plan/effects.h"

#include <functional>

namespace lambent {

struct FrameStats; // gi/contract/figures.h
struct VplSet;     // gi/vpl/vpl_set.h

/// Called during long work with the steps done and the total. May be empty. May throw, which ends the work.
using Progress = std::function<void(int, int)>;
inline const Progress kNoProgress;

/// All that a frame offers before it has surfaces.
struct FrameWorld {
  const World& world;
  const EffectPlan& plan;
  const Settings& settings;
  uint32_t seed = 1;
  bool settingsChanged = false; // of VPLs or effects
  bool gatherChanged = false;   // settings or shaders: pixels gather other light
  /// What is accumulated over frames begins again: world, camera, or settings of light changed. Not for what shows the
  /// light (exposure, tone mapping), nor because a host draws its surfaces again in every frame.
  bool restart = true;
  const Progress& progress = kNoProgress;
};

/// A frame: the world, and what the camera sees of it.
struct Frame : FrameWorld {
  const GBuffer& surfaces;
  Patches& patches; // of the surfaces, made when somebody first asks
  const GBuffer* previous =
      nullptr;     // depth, normals and camera of the frame before; null unless needed, or the first time
  int bounces = 1; // that its light may be reflected
};

/// What a provider shows debug views of its internals. Valid until its next run; null where it has none.
struct ProviderInside {
  SurfaceLighting gathered; // before the mean over frames and the filter
  ParaboloidMaps maps;
  const VplSet* vpls = nullptr;
};

class LightProvider {
 public:
  virtual ~LightProvider() = default;

  /// Waits until nothing of it runs in parallel with the GPU any more.
  virtual void wait() {}
  /// Called when a frame of this view begins, while nothing of the provider runs.
  virtual void begin(const SceneView&, const Settings&) {}
  /// Drops all that belongs to the last scene: another one follows.
  virtual void forget() {}
  /// Returns how far the last frame brought it. The plan draws again while something is pending.
  virtual ProviderStatus status() const { return {}; }
  /// Updates what outlives frames, in every frame, before surfaces are drawn. Adds its work to the figures.
  virtual void update(const FrameWorld&, FrameStats&) {}
  /// Computes irradiance at the frame's surfaces, W/m², rows from the bottom; valid until the next run. Not called
  /// where nothing is to be drawn or the plan has no such light. Adds its rays and counts to the figures.
  virtual SurfaceLighting run(const Frame&, FrameStats&) = 0;
  virtual ProviderInside inside() const { return {}; }
};

} // namespace lambent
