// What bounds take from near virtual lights, traced on the CPU and added to what was gathered.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/gather.h"
#include "gi/gather/add_pixels.h"
#include "gi/near/near_memory.h"

namespace lambent {

class NearLightPass {
 public:
  explicit NearLightPass(PassContext context) : traced_(context, StageId::NearLight) {}
  /// Traces near light and adds it. `grid`: sub-images per axis of the target, 4 or 1.
  void add(const GatherInputs& in, const LightTarget& target, int grid, FrameStats& stats);

 private:
  PixelAdder traced_;
  NearMemory memory_;
};

} // namespace lambent
