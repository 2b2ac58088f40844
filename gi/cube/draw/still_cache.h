// Indirect light of a world that has stood still for long (cube.after): photons, which do not depend on the view, are
// put into a layered depth cube beside the technique that runs, a few in every picture, and when all are in it the cube
// takes that technique's place: a camera that moves then pays a look-up. As soon as light changes the technique is
// back. Either way one is mixed into the other over some pictures, so that what they disagree about is no jump.
#pragma once

#include "gi/contract/indirect_stage.h"
#include "gi/contract/pass_context.h"
#include "gi/sources/light_source.h"
#include "gi/plan/effects.h"

#include <memory>

namespace lambent {

struct StillCacheInputs {
  const World& world;
  const GBuffer& surfaces;
  Patches& patches;
  const EffectPlan& plan;
  const Settings& settings;
  uint32_t seed;
  int bounces;
};

class StillCache {
 public:
  explicit StillCache(PassContext context) : context_(context) {}

  /// Once a frame, before its plan: has light stood still long enough?
  void watch(const SceneView& view, const Settings& settings);
  /// The scene is another.
  void forget() {
    drop();
    still_ = 0;
    wanted_ = false;
  }

  /// It shows all of the indirect light: nothing else need be gathered.
  bool alone() const { return wanted_ && share_ >= 1; }
  /// The cube is being built, or comes or goes: pictures change though nothing moves.
  bool busy() const { return (wanted_ && !alone()) || (!wanted_ && share_ > 0); }

  /// Builds, looks up and mixes; `gathered` where nothing of it is shown yet.
  SurfaceLighting run(const StillCacheInputs& in, const SurfaceLighting& gathered, FrameStats& stats);

 private:
  /// Gives up the cube.
  void drop() {
    photons_ = nullptr;
    cube_ = nullptr;
    share_ = 0;
    stale_ = false;
  }

  PassContext context_;
  std::unique_ptr<LightSource> photons_;
  std::unique_ptr<IndirectStage> cube_;
  VirtualLights lights_; // of photons_
  std::unique_ptr<LightTarget> mixed_;
  Settings settings_; // that the cube was built for
  int still_ = 0;     // frames
  bool wanted_ = false;
  bool stale_ = false; // light changed after the cube was begun: it goes before another is built
  float share_ = 0;    // of the light that is shown
};

} // namespace lambent
