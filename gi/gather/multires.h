// The multiresolution buffer of papers 2 and 3: smooth parts of the picture gather as one.
//   PatchPass      pyramid of patches: how far each is from one smooth surface         patches.cpp, pyramid.frag
//   MultiresPass   marks the patches that gather, in the stencil of a flattened atlas    multires.cpp, refine.frag
//                  gathers there, from any lights, with or without shadow maps          gather.frag (PATCHES)
//                  or splats the lights there                                           splat.cpp
//                  makes the levels whole from coarse to fine                           upsample.frag
#pragma once

#include "gi/gather/splat.h"

namespace lambent {

/// Pyramid over a picture, or over maps side by side. Level λ ≥ 1 has patches of 2^λ pixels and is mip level λ − 1 of
/// the textures, which are padded so that all levels divide evenly.
struct PatchPyramid {
  const gl::Texture* plane = nullptr;    // RGBA32F: see pyramid.frag
  const gl::Texture* normalLo = nullptr; // RGBA16F: least normal; a: 1 where the patch is to be split
  const gl::Texture* normalHi = nullptr; // RGBA16F: largest normal
  int levels = 0;                        // 0: single pixels only, no textures
  glm::ivec2 padded{0};                  // pixels
};

struct PatchInputs {
  const gl::Texture& depth;  // reversed, affine on planes; 0 where nothing is seen
  const gl::Texture& normal; // unit
  glm::ivec2 size;           // pixels
  glm::ivec2 cell;           // of one map; `size` for a picture
  int levels = 0;
  float orthoScale = 0;    // depth range over half the width of maps by parallel rays
  int orthoFrom = 1 << 20; // the first of these, row by row; all before it have a perspective
  float depthThreshold, normalThreshold;
  bool balance = true; // as MultiresSettings
  bool edges = true;
};

class PatchPass {
 public:
  PatchPass(PassContext context, StageId stage) : context_(context), stage_(stage), name_(key(stage).name) {}
  PatchPyramid run(const PatchInputs& in);

 private:
  PassContext context_;
  StageId stage_;
  std::string name_;
  gl::Texture plane_, normalLo_, normalHi_;
  std::vector<gl::Framebuffer> framebuffers_; // by mip level
};

/// The atlas's shape: see shaders/shared/patches.h.
struct AtlasShape {
  glm::ivec2 base{0}; // level 0, texels
  int coarsest = 0;   // level
  int grid = 1;       // sub-images per axis
  bool glossy = false;

  glm::ivec2 sub(int level) const { return base / grid / (1 << level); }
  int gridLevel() const { return grid == 4 ? 2 : 0; }
  bool operator==(const AtlasShape&) const = default;
};

struct MultiresInputs {
  const GBuffer& gbuffer;
  const VplLights& lights;
  const ParaboloidMaps* maps = nullptr; // null: no visibility
  float bias = 1;                       // ShadowSettings::bias, texels
  const GatherSettings& gather;
  const MultiresSettings& multires;
  const FilterSettings& filter;      // weights of the upsampling
  const LightTrees* trees = nullptr; // gathered in place of `lights`
};

class MultiresPass {
 public:
  explicit MultiresPass(PassContext context) : context_(context) {}
  RawIndirect run(const MultiresInputs& in);
  const PatchPyramid& patches() const { return pyramid_; } // of the last run
  /// Patches that the stencil marked, of all subsets, in the last run that is known of: does not wait for the GPU.
  uint64_t patchesMarked();
  /// Patches that hold light after the last run, gathered or splatted. Reads the atlas back.
  uint64_t countPatches() const;

 private:
  void allocate(const AtlasShape& shape, const glm::ivec2& target);
  void mark(const MultiresInputs& in);
  void gather(const MultiresInputs& in);
  void splatEach(const MultiresInputs& in);
  GatherDraw drawOf(const MultiresInputs& in) const;
  void clear(const MultiresInputs& in);
  void upsample(const MultiresInputs& in, bool add = false);

  PassContext context_;
  SplatPass splatPass_{context_};
  PatchPass patchPass_{context_, StageId::Patches};
  PatchPyramid pyramid_;
  gl::Query marks_;
  uint64_t marked_ = 0;
  AtlasShape shape_;
  gl::Texture atlas_, stencil_, levels_, irradiance_; // levels_: level l ≥ 1 made whole is mip level l − 1
  gl::Texture atlasGlossy_, levelsGlossy_, glossy_;   // beside them, when the G-buffer has finishes
  gl::Framebuffer atlasFramebuffer_, stencilFramebuffer_, framebuffer_;
  std::vector<gl::Framebuffer> levelFramebuffers_;
};

} // namespace lambent
