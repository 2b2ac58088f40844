// Which effects a scene and a frame call for: every optional part of the work, on or off, each with its reason in plain
// words. A pure function of the view, the settings and a few facts about the last frame. What is off does not run at
// all; settings force each on or off for comparison.
#pragma once

#include "engine/view/scene_view.h"
#include "gi/plan/needs.h"
#include "gi/plan/settings.h"

#include <array>
#include <cstdint>
#include <string>

namespace lambent {

/// One row per effect: how it is named, and the unit in which FrameStats counts its work.
struct EffectRow {
  const char* name;
  const char* help; // what it does; what leaving it out does to the image
  const char* work;
};
const EffectRow& effectRow(EffectId id);

struct Effect {
  bool on = false;
  bool calledFor = false; // what the plan would be if settings did not force it
  bool forced = false;    // by settings
  std::string reason;
};

/// What a plan depends on, apart from the scene and the settings.
struct FrameFacts {
  bool first = true;           // no frame was drawn yet
  bool settingsChanged = true; // of VPLs or effects
  bool drawingChanged = true;  // other settings, or the shaders
  Needs needs;                 // of the technique that runs
  ProviderStatus status;       // of its provider, after the last frame
  bool directPending = false;  // direct light of the last frame would go on getting better
  bool mirrorsPending = false; // what smooth surfaces mirror in it would
};

class EffectPlan {
 public:
  bool on(EffectId id) const { return effects_[size_t(id)].on; }
  bool calledFor(EffectId id) const { return effects_[size_t(id)].calledFor; }
  /// Says whether the effect is on without need: the work is done and must not change anything.
  bool idle(EffectId id) const { return on(id) && !calledFor(id); }
  const Effect& operator[](EffectId id) const { return effects_[size_t(id)]; }
  /// Says whether the frame would be drawn again even if light were not averaged over frames.
  bool changed() const { return changed_; }
  /// Says whether visible surfaces, or their direct light, may differ from the last frame's.
  bool seenChanges() const { return seenChanges_; }
  /// Says whether light in the scene may differ from the last frame's, not only what the camera sees of it.
  bool lightChanges() const { return lightChanges_; }
  /// Says whether the frame is drawn again for direct light alone: indirect light stays as it is.
  bool onlyDirect() const { return onlyDirect_; }
  /// Names of the effects that are on, separated by '+'; "none".
  std::string oneLine() const;

 private:
  friend EffectPlan planEffects(const SceneView&, const Settings&, const FrameFacts&);
  std::array<Effect, kEffects> effects_;
  bool changed_ = true, seenChanges_ = true, lightChanges_ = true, onlyDirect_ = false;
};

/// Says whether a material is somewhere so smooth that rays bring what it mirrors (mirrorShare in
/// shaders/shared/ggx.h).
bool mirrors(const SceneAssets& assets, const Material& material);

/// Plans a frame. `view.changes` decides: what did not change needs no work.
EffectPlan planEffects(const SceneView& view, const Settings& settings, const FrameFacts& facts);

} // namespace lambent
