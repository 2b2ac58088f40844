// What smooth surfaces mirror of the scene (gi/near/mirror_rays.h), averaged over frames, denoised and added to a
// technique's light.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/light_provider.h"
#include "gi/reconstruct/reconstruct.h"

namespace lambent {

class MirrorPass {
 public:
  explicit MirrorPass(PassContext context) : context_(context) {}

  /// Takes gather.mirrors more samples of every pixel, and returns the others' light with their mean. Valid until the
  /// next run. Waits for the GPU, which knows the finish of the image's pixels.
  SurfaceLighting add(const Frame& frame, const SurfaceLighting& others, FrameStats& stats);
  void forget();
  /// Says whether the next frame of a still view would have more samples in its mean.
  bool pending() const { return averaged_ > 0 && averaged_ < rests_; }

 private:
  PassContext context_;
  LightTarget samples_{"mirrors"}, sum_{"mirrors/sum"};
  HistoryPass history_{context_, StageId::Mirrors};
  DenoisePass denoise_{context_, StageId::Mirrors};
  std::vector<vec4> finish_;     // of this frame's surfaces
  SurfaceLighting denoised_;     // of the last frame
  int averaged_ = 0, rests_ = 0; // frames since anything changed; after which a still view rests
};

} // namespace lambent
