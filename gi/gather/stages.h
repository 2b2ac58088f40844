// Gathers of virtual lights, as stages of indirect light, and what puts their light together. Contents of this folder
// in data-flow order:
//   draw_gather     the draw that all of them share
//   pixel_gather    at pixels: every light at each, or the 4×4 subsets of interleaved sampling
//   ray_gather      at pixels, on the CPU, with a ray for every pair
//   patch_atlas     the multiresolution buffer of papers 2 and 3, flattened; from its patches to pixels
//   patch_gather    at the patches that it marks
//   splat, splat_gather  lights into patches
//   tree_gather     the draw of light trees
//   near_light_pass what bounds take from near lights, added to any of these
//   filter          the subsets mixed
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/indirect_stage.h"
#include "gi/contract/pass_context.h"

namespace lambent {

std::unique_ptr<IndirectStage> makePixelGather(PassContext context);
std::unique_ptr<IndirectStage> makeRayGather(PassContext context);
std::unique_ptr<IndirectStage> makePatchGather(PassContext context);
std::unique_ptr<IndirectStage> makeSplatGather(PassContext context);

/// The stages, each made when it is first asked for and kept.
class IndirectStages {
 public:
  explicit IndirectStages(PassContext context) : context_(context) {}
  /// The stage that the settings' axes ask for.
  IndirectStage& of(const Settings& settings);

 private:
  using Make = std::unique_ptr<IndirectStage> (*)(PassContext);
  PassContext context_;
  std::vector<std::pair<Make, std::unique_ptr<IndirectStage>>> made_;
};

struct HistoryInputs {
  const GBuffer& surfaces;
  const LightOnSurfaces& gathered;
  const LightOnSurfaces* fresh; // the same, filtered, where light changes; what is kept then keeps to its range
  bool camera;                  // moves: glossy light is this picture's own
  const HistorySettings& settings;
};

/// The mean of what was gathered at the place of each pixel in this picture and those before it.
class HistoryPass {
 public:
  explicit HistoryPass(PassContext context) : context_(context) {}
  LightOnSurfaces run(const HistoryInputs& in);
  void forget() { pictures_ = 0; }

 private:
  /// One picture's light, and where the surfaces lay that it fell on.
  struct Kept {
    gl::Texture irradiance, seen, glossy;
    gl::Framebuffer framebuffer;
  };
  void fit(const GBuffer& surfaces);

  PassContext context_;
  Kept kept_[2];
  int now_ = 0;
  uint32_t pictures_ = 0; // since it was forgotten
  CameraBlock before_;
  gl::Ring cameras_{"history/camera"};
};

struct FilterInputs {
  const GBuffer& surfaces;
  const LightOnSurfaces& gathered;
  const FilterSettings& filter;
};

/// Cross-bilateral 7×7; with the filter off only puts the pixels back in their places. Light that is in its place
/// passes through.
class FilterPass {
 public:
  explicit FilterPass(PassContext context) : context_(context) {}
  LightOnSurfaces run(const FilterInputs& in);

 private:
  PassContext context_;
  LightTarget target_{"filter"}, rows_{"filter/rows"};
};

} // namespace lambent
