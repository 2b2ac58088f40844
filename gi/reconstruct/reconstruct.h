// How gathered light becomes the frame's. Contents of this folder in data-flow order:
//   history  what pixels gathered, averaged over frames
//   filter   the subsets mixed
//   denoise  the noise of samples, as far as neighbours are alike within it
// From patches to pixels: gi/gather/patch_atlas.h.
#pragma once

#include "engine/gl/ring.h"
#include "gi/contract/light_change_map.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/surface_lighting.h"
#include "gi/plan/settings.h"

namespace lambent {

struct FilterInputs {
  const GBuffer& surfaces;
  const SurfaceLighting& gathered;
  const FilterSettings& filter;
  const gl::Texture* worth = nullptr; // of a mean: HistoryPass::worth; the more frames, the less its neighbours count
};

/// Filters with a cross-bilateral 7×7 kernel; with the filter off only puts the pixels back in their places. Light of
/// every class, in its place, passes through.
class FilterPass {
 public:
  explicit FilterPass(PassContext context) : context_(context) {}
  SurfaceLighting run(const FilterInputs& in);

 private:
  PassContext context_;
  LightTarget target_{"filter"}, rows_{"filter/rows"};
};

struct HistoryInputs {
  const GBuffer& surfaces;
  const SurfaceLighting& gathered;
  bool cameraMoved;  // glossy light is then of few frames
  bool lightChanges; // what is kept then follows this frame; glossy light is of few
  const HistorySettings& settings;
  const FilterSettings& filter;
  float follow = 0.5f;         // share of a coarse change that its first frame shows
  SurfaceLighting smooth = {}; // the frame before, denoised, or null: what variance is about; its edges end means
  const LightChangeMap* change = nullptr; // what lights know of it, or null
  bool apart = false;      // the noise of pixels is each its own, so that a change of light is told from it
  float cycleFrames = 0;   // of classes, in which every light comes once: a mean of fewer before this counts as its
                           // share of them, squared; 0: as many as it holds
  bool otherNoise = false; // the noise of a frame is of another kind than the last's, so its variance is not known
  int glossyFrames = 0;    // earlier frames that a mean of glossy light holds at most while camera or light moves
};

/// Averages what was gathered at the place of each pixel in this frame and those before it.
class HistoryPass {
 public:
  explicit HistoryPass(PassContext context, StageId stage = StageId::History) : context_(context), stage_(stage) {}
  /// Makes room; call it before the gather. Frames of another size are looked up like any others; those of another kind
  /// are forgotten.
  void fit(const GBuffer& surfaces);
  SurfaceLighting run(const HistoryInputs& in);
  void forget() { frames_ = 0, following_ = 0; }
  /// Says whether the next frame of a still view follows light that changed before.
  bool follows() const { return following_ > 0; }
  /// Number of frames in the mean, which is the number of the next sample.
  uint32_t sample() const { return frames_; }
  /// Of the luminance of a pixel's frames: of irradiance, of glossy light. RG32F.
  const gl::Texture& variance() const { return kept_[now_].variance; }
  /// Alpha: frames that a mean is worth, few where looking it up blurs an edge of light; 0: no surface. RGBA32F.
  const gl::Texture& worth() const { return kept_[now_].seen; }

 private:
  /// A frame's light, and the surfaces that it fell on.
  struct Kept {
    gl::Texture irradiance, seen, glossy, variance;
    gl::Framebuffer framebuffer;
  };
  void find(const HistoryInputs& in, const Kept& before, const gl::Framebuffer& to, bool changes);
  void follow(const HistoryInputs& in, const Kept& now);

  PassContext context_;
  FilterPass filter_{context_};
  StageId stage_;
  Kept kept_[2];
  // Where light changes: what is kept, and this frame's difference to it; the mean of glossy light.
  gl::Texture found_, change_, foundGlossy_, foundVariance_;
  gl::Texture tiles_; // by how much it changes
  gl::Framebuffer changing_, tilesFramebuffer_;
  int now_ = 0;
  uint32_t frames_ = 0; // since it was forgotten
  int following_ = 0;   // frames that are still to be followed
  CameraBlock before_;  // the last frame's
  gl::Ring cameras_{"history/camera"};
};

struct DenoiseInputs {
  const GBuffer& surfaces;
  const SurfaceLighting& mean;         // of HistoryPass
  const gl::Texture &variance, &worth; // HistoryPass's
  const FilterSettings& filter;
  int steps = 3; // of the filter: of 1, 2, 4 … pixels
};

/// Averages each pixel with neighbours that are alike within its noise: à-trous wavelets guided by variance (Schied et
/// al., "Spatiotemporal variance-guided filtering", 2017). Light without noise stays as it is.
class DenoisePass {
 public:
  explicit DenoisePass(PassContext context, StageId stage) : context_(context), stage_(stage) {}
  SurfaceLighting run(const DenoiseInputs& in);

 private:
  PassContext context_;
  StageId stage_;
  LightTarget targets_[2]{LightTarget("denoise/even"), LightTarget("denoise/odd")};
};

} // namespace lambent
