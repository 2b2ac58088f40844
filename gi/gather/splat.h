// Paper 2's gather the other way round: every VPL is splatted, as points, into the patches of the multiresolution
// buffer.
#pragma once

#include "gi/gather/patch_atlas.h"

namespace lambent {

struct SplatInputs {
  const GatherDraw& draw; // areas are not used
  const PatchPyramid& patches;
  const AtlasShape& shape;  // of one sub-image
  float lightThreshold = 0; // MultiresSettings::light
};

class SplatPass {
 public:
  explicit SplatPass(PassContext context) : context_(context) {}
  /// Lists the subsplats: the patches that a gather would mark, refined from the coarsest by one geometry-shader pass
  /// per level.
  void refine(const SplatInputs& in);
  /// The same for one VPL, by its light too. `slot` is the VPL's.
  void refineFor(const SplatInputs& in, uint32_t slot);
  /// Adds up the listed subsplats of all VPLs, or of one, in the framebuffer of the atlas.
  void splat(const SplatInputs& in, const gl::Framebuffer& atlas);
  void splatOne(const SplatInputs& in, const gl::Framebuffer& atlas, uint32_t slot);

 private:
  void refineList(const SplatInputs& in, const gl::Program& first, const gl::Program& next);
  void drawPoints(const SplatInputs& in, const gl::Framebuffer& atlas, uint32_t chunk, int block, int firstLight,
                  int lights);

  PassContext context_;
  gl::Buffer lists_[2];                // ivec3: texel and level
  gl::TransformFeedback feedbacks_[2]; // that write them
  gl::VertexArray arrays_[2];          // that read them
  int list_ = 0;                       // the finished one
};

} // namespace lambent
