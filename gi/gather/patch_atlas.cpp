#include "gi/gather/patch_atlas.h"

#include "engine/core/error.h"
#include "shaders/shared/patches.h"

#include <algorithm>

namespace lambent {

void PatchAtlas::fit(const GBuffer& surfaces, const PatchPyramid& patches, bool subsets) {
  AtlasShape shape{.grid = subsets ? 4 : 1, .glossy = surfaces.finish != nullptr};
  // Patches of 4 × 4 pixels are what interleaving makes anyway.
  const int levels = subsets && patches.levels < 3 ? 0 : patches.levels;
  shape.coarsest = std::max(0, levels - shape.gridLevel());
  shape.finest = std::max(0, patches.finest - shape.gridLevel());
  const int multiple = std::max(1 << levels, shape.grid);
  shape.base = (glm::ivec2(surfaces.width, surfaces.height) + multiple - 1) / multiple * multiple;
  target_.fit(surfaces, subsets ? 4 * tileSize(surfaces) : glm::ivec2(surfaces.width, surfaces.height));
  if (atlas_ && shape == shape_) return;
  shape_ = shape;
  const glm::ivec2 size = atlasSize(shape.base, shape.coarsest);
  const auto make = [](const char* label, const glm::ivec2& texels, int levels = 1) {
    return gl::Texture(label, {.format = GL_RGBA32F, .width = texels.x, .height = texels.y, .levels = levels});
  };
  stencil_ = gl::Texture("multires/stencil", {.format = GL_DEPTH24_STENCIL8, .width = size.x, .height = size.y});
  atlas_ = make("multires/atlas", size);
  levels_ = shape.coarsest > 0 ? make("multires/levels", shape.base / 2, shape.coarsest) : gl::Texture();
  for (gl::Texture* t : {&atlasGlossy_, &levelsGlossy_}) *t = {};
  if (shape.glossy) {
    atlasGlossy_ = make("multires/glossy atlas", size);
    if (shape.coarsest > 0) levelsGlossy_ = make("multires/glossy levels", shape.base / 2, shape.coarsest);
  }
  framebuffer_ = shape.glossy ? gl::Framebuffer("multires atlas", {&atlas_, &atlasGlossy_}, &stencil_)
                              : gl::Framebuffer("multires atlas", {&atlas_}, &stencil_);
  levelFramebuffers_.clear();
  for (int i = 0; i < shape.coarsest; ++i)
    levelFramebuffers_.push_back(shape.glossy
                                     ? gl::Framebuffer("multires level", {&levels_, &levelsGlossy_}, nullptr, i)
                                     : gl::Framebuffer("multires level", {&levels_}, nullptr, i));
}

void PatchAtlas::clear() const {
  gl::PipelineState{.width = atlas_.width(), .height = atlas_.height()}.apply(); // clearing keeps to the scissor
  const float nothing[4] = {};
  for (int i = 0; i < (shape_.glossy ? 2 : 1); ++i)
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, i, nothing);
}

void PatchAtlas::put(int level, std::span<const vec4> values) const {
  const glm::ivec2 at = atlasOrigin(shape_.base, level), size = shape_.sub(level);
  CHECK_EQ(values.size(), size_t(size.x) * size_t(size.y));
  glTextureSubImage2D(atlas_.name(), 0, at.x, at.y, size.x, size.y, GL_RGBA, GL_FLOAT, values.data());
}

void PatchAtlas::upsample(const GBuffer& surfaces, const Settings& settings, bool add) {
  const std::vector<std::string> receivers = bindSurfaces(surfaces);
  atlas_.bind(2);
  if (shape_.glossy) atlasGlossy_.bind(4);
  for (int level = shape_.coarsest; level >= 0; --level) {
    gl::ProgramDesc desc{.fragment = "upsample.frag", .defines = receivers};
    if (level == 0) desc.defines.push_back("FINAL");
    if (settings.multires.upsample == PatchUpsample::Bilinear) desc.defines.push_back("BILINEAR");
    const gl::Program& program = context_.programs.get(desc);
    program.use();
    program.set("base", shape_.base);
    program.set("level", level);
    program.set("coarsest", shape_.coarsest);
    program.set("grid", shape_.grid);
    program.set("finestPatch", shape_.finest);
    program.set("tile", shape_.grid == 4 ? tileSize(surfaces) : glm::ivec2(surfaces.width, surfaces.height));
    program.set("normalPower", settings.filter.normalPower);
    program.set("distanceSigma", settings.filter.distance);
    program.set("detail", settings.multires.detail);
    if (level < shape_.coarsest) {
      levels_.limitLevels(level, level); // level + 1 of the atlas
      levels_.bind(3);
      if (shape_.glossy) {
        levelsGlossy_.limitLevels(level, level);
        levelsGlossy_.bind(5);
      }
    }
    const glm::ivec2 size = level == 0 ? target_.size() : glm::ivec2(levels_.width(), levels_.height()) >> (level - 1);
    (level == 0 ? target_.framebuffer() : levelFramebuffers_[level - 1]).bind();
    gl::PipelineState{.add = add && level == 0, .width = size.x, .height = size.y}.apply();
    gl::drawFullscreen();
  }
}

} // namespace lambent
