// The multiresolution buffer of papers 2 and 3, flattened: light at patches of all sizes side by side, and the way from
// there to pixels.
#pragma once

#include "gi/contract/gather.h"
#include "gi/gather/draw_gather.h"

namespace lambent {

/// See shaders/shared/patches.h.
struct AtlasShape {
  glm::ivec2 base{0}; // level 0, texels
  int coarsest = 0;   // level
  int finest = 0;     // as PatchPyramid, of a sub-image
  int grid = 1;       // sub-images per axis
  bool glossy = false;

  glm::ivec2 sub(int level) const { return base / grid / (1 << level); }
  int gridLevel() const { return grid == 4 ? 2 : 0; }
  bool operator==(const AtlasShape&) const = default;
};

class PatchAtlas {
 public:
  explicit PatchAtlas(PassContext context) : context_(context) {}

  /// Lays the atlas out for the image's patches, or with `subsets` for those of each of the 16 sub-images.
  void fit(const GBuffer& surfaces, const PatchPyramid& patches, bool subsets);
  const AtlasShape& shape() const { return shape_; }
  const gl::Framebuffer& framebuffer() const { return framebuffer_; } // with the stencil
  const gl::Texture& stencil() const { return stencil_; }

  /// Makes the atlas black.
  void clear() const;
  /// Sets what the patches of a level hold, row by row over the padded image.
  void put(int level, std::span<const vec4> values) const;
  void bind(int unit) const { atlas_.bind(unit); }
  void clearLight() const { target_.clear(); }
  /// Upsamples from the patches to pixels, coarse to fine; `add`: adds to what the pixels hold.
  void upsample(const GBuffer& surfaces, const Settings& settings, bool add = false);
  SurfaceLighting light() const { return target_.light(shape_.grid > 1); }
  const LightTarget& target() const { return target_; } // of the pixels

 private:
  PassContext context_;
  AtlasShape shape_;
  gl::Texture atlas_, stencil_, levels_;   // levels_: level l ≥ 1 made whole is mip level l − 1
  gl::Texture atlasGlossy_, levelsGlossy_; // with them, when the G-buffer has roughness and metalness
  gl::Framebuffer framebuffer_;
  std::vector<gl::Framebuffer> levelFramebuffers_;
  LightTarget target_{"multires"};
};

} // namespace lambent
