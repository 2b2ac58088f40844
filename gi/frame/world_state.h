// The scene from frame to frame: taken over, placed for rays and for drawing as far as the plan goes; and the plan.
#pragma once

#include "engine/trace/embree_query.h"
#include "engine/view/view_copy.h"
#include "gi/contract/figures.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/world.h"
#include "gi/lighting/dirty_region.h"
#include "gi/lighting/light_set.h"
#include "gi/plan/settings.h"
#include "gi/surfaces/gpu_scene.h"

namespace lambent {

/// What a plan depends on, apart from the view and the settings.
struct PlanInputs {
  bool first = true; // there is no frame yet
  bool host = false; // the surfaces are a host's, who may have drawn them again
  Needs needs;       // of the technique
  ProviderStatus status;
  bool directPending = false, mirrorsPending = false; // as FrameFacts
};

class WorldState {
 public:
  explicit WorldState(const PassContext& context) : context_(context) {}

  /// Prepares for a scene. Returns whether it is another one; what came to the last one, or went, is only taken over.
  bool open(const SceneAssets& assets, const Settings& settings, FrameStats& stats);
  /// Takes the view over.
  void take(const SceneView& given, const Settings& settings);
  const SceneView& view() const { return view_.view(); }
  /// Decides what is done in this frame. A change stays one until every stage has seen it.
  EffectPlan plan(const Settings& settings, const PlanInputs& in);
  /// Places the view as the plan allows; valid until the next plan.
  World place(const EffectPlan& plan, FrameStats& stats);
  /// Adds to the figures what rays and draws met since the last call.
  void countWork(FrameStats& stats);

  bool settingsChanged() const { return settingsChanged_; } // of VPLs or effects
  bool gatherChanged() const { return gatherChanged_; }     // settings or shaders: pixels gather other light
  void shadersChanged() { shadersChanged_ = true; }
  /// Returns the world as last placed.
  World current() const { return {view_.view(), *gpu_, *rays_, moved_, lights_, farDistance_}; }

 private:
  PassContext context_;
  uint64_t opened_ = 0, revision_ = 0; // identity and revision of its assets
  std::unique_ptr<GpuScene> gpu_;
  std::unique_ptr<EmbreeQuery> rays_;
  ViewCopy view_;
  DirtyRegion moved_;
  LightSet lights_;
  Settings before_;
  float farDistance_ = 0;
  uint64_t testedDraws_ = 0; // the scene's count when last asked
  bool settingsChanged_ = true, gatherChanged_ = true, shadersChanged_ = false;
  bool hosted_ = false;        // the last surfaces were a host's
  bool frozen_ = false;        // objects stand where they stood
  bool lightingStale_ = false; // something changed that not all stages have seen
  bool surfacesStale_ = false; // nor those of surfaces and direct light
};

} // namespace lambent
