// Where virtual lights come from: a list that is sampled on the CPU (gi/sources), or reflective shadow maps
// (gi/reflective).
#pragma once

#include "gi/contract/light_provider.h"
#include "gi/contract/virtual_lights.h"

namespace lambent {

class LightSource {
 public:
  virtual ~LightSource() = default;
  /// Returns this frame's lights, valid until the next run; none of them is packed or listed where nothing is redrawn.
  virtual VirtualLights run(const FrameWorld& in, const Needs& needs, FrameStats& stats) = 0;

  /// Waits for an update that still runs in parallel with the GPU. Afterwards `arrived` says whether there are lights
  /// that no frame shows yet.
  virtual void wait() {}
  virtual bool arrived() const { return false; }
  /// Says whether no better lights are in reach (gi/vpl/settling.h).
  virtual bool settled() const { return false; }
  /// Returns the set on the CPU if the source keeps one, else null. Call wait() before.
  virtual const VplSet* set() const { return nullptr; }
  /// Drops all that belongs to the last scene.
  virtual void forget() {}
};

} // namespace lambent
