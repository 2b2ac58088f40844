// Gathers of virtual lights, as stages of indirect light, and what puts their light together. Contents of this folder
// in data-flow order:
//   draw_gather     the draw that all of them share
//   pixel_gather    at pixels: every light at each, or the 4×4 subsets of interleaved sampling
//   ray_gather      at pixels, on the CPU, with a ray for every pair
//   add_pixels      what the CPU found at pixels, added to what was gathered
//   patch_atlas     the multiresolution buffer of papers 2 and 3, flattened; from its patches to pixels
//   patch_gather    at the patches that it marks
//   splat, splat_gather  lights into patches
//   light_volume, volume_gather  lights into a grid, through it, and from there to pixels
//   hemicube_pass   what these lights see, drawn or cast
//   cube_gather     lights into a layered depth cube (gi/cube), and from there to pixels
//   tree_gather     the draw of light trees
//   map_checks      rays that check what maps say at pixels
//   near_light_pass what bounds take from near lights, added to any of these
//   history         what pixels gathered, averaged over pictures
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
std::unique_ptr<IndirectStage> makeVolumeGather(PassContext context);
std::unique_ptr<IndirectStage> makeCubeGather(PassContext context);

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

struct FilterInputs {
  const GBuffer& surfaces;
  const SurfaceLighting& gathered;
  const FilterSettings& filter;
  bool fresh = true; // of one picture; else a texel's alpha says how many sixteenths of the lights it holds evenly
};

/// Cross-bilateral 7×7; with the filter off only puts the pixels back in their places. Light of every class, in its
/// place, passes through.
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
  bool cameraMoved;  // glossy light is then this picture's own
  bool lightChanges; // what is kept then follows this picture
  const HistorySettings& settings;
  const FilterSettings& filter;
};

/// The mean of what was gathered at the place of each pixel in this picture and those before it.
class HistoryPass {
 public:
  explicit HistoryPass(PassContext context) : context_(context) {}
  /// Before the gather: makes room. Pictures of another size are looked up like any others; those of another kind are
  /// forgotten.
  void fit(const GBuffer& surfaces);
  SurfaceLighting run(const HistoryInputs& in);
  void forget() { pictures_ = 0, following_ = 0; }
  /// Whether the next picture of a still view follows light that changed before.
  bool follows() const { return following_ > 0; }
  /// Pictures in it: which of those that are averaged the next one is.
  uint32_t picture() const { return pictures_; }

 private:
  /// A picture's light, and the surfaces that it fell on.
  struct Kept {
    gl::Texture irradiance, seen, glossy;
    gl::Framebuffer framebuffer;
  };
  void find(const HistoryInputs& in, const Kept& before, const gl::Framebuffer& to, bool changes);
  void follow(const HistoryInputs& in, const Kept& now);

  PassContext context_;
  FilterPass filter_{context_};
  Kept kept_[2];
  gl::Texture found_, change_; // where light changes: what is kept, and this picture's difference to it
  gl::Texture tiles_;          // by how much it changes
  gl::Framebuffer changing_, tilesFramebuffer_;
  int now_ = 0;
  uint32_t pictures_ = 0; // since it was forgotten
  int following_ = 0;     // pictures that are still to be followed
  CameraBlock before_;    // the last picture's
  gl::Ring cameras_{"history/camera"};
};

} // namespace lambent
