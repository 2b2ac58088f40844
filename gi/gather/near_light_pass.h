// What bounds take from near virtual lights, traced on the CPU and added to what was gathered.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/indirect_stage.h"
#include "gi/contract/pass_context.h"

namespace lambent {

class NearLightPass {
 public:
  explicit NearLightPass(PassContext context) : context_(context) {}
  /// `grid`: sub-images per axis of the target, 4 or 1.
  void add(const IndirectInputs& in, const LightTarget& target, int grid, FrameStats& stats);

 private:
  PassContext context_;
  LightTarget traced_{"near light"};
};

/// Puts pixels (row by row from the top) where drawGather puts them.
void uploadPixels(const gl::Texture& texture, std::span<const vec3> pixels, const GBuffer& surfaces, int grid);

} // namespace lambent
