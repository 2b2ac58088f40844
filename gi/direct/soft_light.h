// Direct light by few rays from every pixel (soft_sampler.h), averaged over frames and denoised.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/light_provider.h"
#include "gi/direct/soft_sampler.h"
#include "gi/reconstruct/reconstruct.h"

namespace lambent {

class SoftLightPass {
 public:
  explicit SoftLightPass(PassContext context) : context_(context) {}

  /// Takes direct.samples more of every pixel and adds the mean to the target, which is as large as the image.
  void add(const Frame& frame, SurfaceReader& reader, SoftParts parts, const LightTarget& target, FrameStats& stats);
  void forget() {
    history_.forget();
    averaged_ = 0;
  }
  /// Says whether the next frame of a still view would have more samples in its mean.
  bool pending() const { return averaged_ > 0 && averaged_ < rests_; }

 private:
  /// How many samples beyond direct.samples each pixel gets: more where the mean of its place held few frames.
  MoreSamples more(const Frame& frame);
  /// Finds these for the frame after this one.
  void findNext(const Frame& frame);

  PassContext context_;
  LightTarget samples_{"soft light"};
  HistoryPass history_{context_, StageId::SoftLight};
  DenoisePass denoise_{context_, StageId::SoftLight};
  SoftParts parts_ = SoftParts::All;
  SurfaceLighting denoised_; // of the last frame
  gl::Texture next_;         // by the last frame: samples beyond direct.samples
  gl::Framebuffer nextFramebuffer_;
  CameraBlock before_;              // of the last frame
  std::vector<uint8_t> nextPixels_; // of the last frame, rows from the bottom
  int averaged_ = 0, rests_ = 0;    // frames since anything changed; after which a still view rests
};

} // namespace lambent
