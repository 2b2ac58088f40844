// Where virtual lights come from: a list that is sampled on the CPU (gi/sources), or reflective shadow maps
// (gi/reflective).
#pragma once

#include "gi/contract/light_provider.h"
#include "gi/contract/virtual_lights.h"

namespace lambent {

class LightSource {
 public:
  virtual ~LightSource() = default;
  /// This frame's lights, valid until the next run; none of them is packed or listed where nothing is redrawn.
  virtual VirtualLights run(const FrameWorld& in, const Needs& needs, FrameStats& stats) = 0;

  /// Waits for an update that still runs next to the GPU. `arrived` afterwards: lights that no frame shows yet.
  virtual void wait() {}
  virtual bool arrived() const { return false; }
  /// No better lights are in reach (gi/vpl/settling.h).
  virtual bool settled() const { return false; }
  /// The set on the CPU, if the source keeps one; call wait() before.
  virtual const VplSet* set() const { return nullptr; }
  /// The scene is another.
  virtual void forget() {}
};

} // namespace lambent
