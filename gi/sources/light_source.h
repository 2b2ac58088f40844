// Where virtual lights come from: a list that is sampled on the CPU, or reflective shadow maps.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/virtual_lights.h"
#include "gi/contract/world.h"
#include "gi/plan/settings.h"
#include "gi/vpl/vpl_set.h"

#include <functional>
#include <memory>

namespace lambent {

struct SourceInputs {
  const World& world;
  const EffectPlan& plan;
  const Settings& settings;
  uint32_t seed = 1;
  bool settingsChanged = false; // of VPLs or effects
  const std::function<void(int, int)>& progress;
};

class LightSource {
 public:
  virtual ~LightSource() = default;
  /// This frame's lights, valid until the next run; none of them is packed or listed where nothing is redrawn.
  virtual VirtualLights run(const SourceInputs& in, FrameStats& stats) = 0;

  /// Waits for an update that still runs beside the GPU. `arrived` afterwards: lights that no picture shows yet.
  virtual void wait() {}
  virtual bool arrived() const { return false; }
  /// No better lights are in reach (gi/vpl/settling.h).
  virtual bool settled() const { return false; }
  /// The set on the CPU, if the source keeps one; call wait() before.
  virtual const VplSet* set() const { return nullptr; }
  /// The scene is another.
  virtual void forget() {}
};

/// A source that serves `source`, and every other of its kind (sampled, or reflective). Null for VplSource::None.
std::unique_ptr<LightSource> makeSource(VplSource source, PassContext context);
bool sameKind(VplSource a, VplSource b);

} // namespace lambent
