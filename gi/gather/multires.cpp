// Indirect irradiance gathered at patches. Paper 3, section 3.2: one pass marks the patches in a stencil buffer, the
// gather runs on these only. Beyond the paper: neighbours differ by one level at most, any set of lights with its
// shadow maps, and subsets of interleaved sampling (paper 1, 4.5), each with a multiresolution buffer of its own over
// every fourth pixel; a patch of such a buffer lies within a smooth block of the picture, so that all subsets have the
// same patches.
#include "gi/gather/multires.h"

#include "engine/core/error.h"
#include "shaders/shared/patches.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// Levels of the picture's pyramid.
int levelsFor(const GBuffer& gbuffer, int coarsest, int grid) {
  const float longer = float(std::max(gbuffer.width, gbuffer.height));
  const int levels = std::clamp(int(std::lround(std::log2(longer / float(coarsest)))), 0, 10);
  return grid == 4 && levels < 3 ? 0 : levels; // patches of 4 × 4 pixels are what interleaving makes anyway
}

} // namespace

RawIndirect MultiresPass::run(const MultiresInputs& in) {
  const GBuffer& g = in.gbuffer;
  const bool subsets = interleaved(in.gather.mode);
  AtlasShape shape{.grid = subsets ? 4 : 1, .glossy = g.finish != nullptr};
  const int levels = levelsFor(g, in.multires.coarsest, shape.grid);
  const bool ortho = g.block.lens.w > 0;
  pyramid_ = patchPass_.run({.depth = *g.depth,
                             .normal = *g.normal,
                             .size = {g.width, g.height},
                             .cell = {g.width, g.height},
                             .levels = levels,
                             .orthoScale = ortho ? (g.block.lens.w - g.block.lens.z) / g.block.lens.y : 0,
                             .orthoFrom = ortho ? 0 : 1,
                             .depthThreshold = in.multires.depth,
                             .normalThreshold = in.multires.normal,
                             .balance = in.multires.balance,
                             .edges = in.multires.edges});
  shape.coarsest = std::max(0, levels - shape.gridLevel());
  const int multiple = std::max(1 << levels, shape.grid);
  shape.base = (glm::ivec2(g.width, g.height) + multiple - 1) / multiple * multiple;
  allocate(shape, subsets ? 4 * tileSize(g) : glm::ivec2(g.width, g.height));
  switch (in.trees ? GatherMode::Multires : in.gather.mode) { // a tree has no list of lights to splat
  case GatherMode::SplatPerVpl:
    splatEach(in);
    break;
  case GatherMode::Splat: {
    const GatherDraw draw = drawOf(in);
    const SplatInputs splats{draw, pyramid_, shape_};
    splatPass_.refine(splats);
    clear(in);
    splatPass_.splat(splats, atlasFramebuffer_);
    upsample(in);
    break;
  }
  default:
    mark(in);
    gather(in);
    upsample(in);
  }
  return {&irradiance_, subsets, orNull(glossy_)};
}

void MultiresPass::allocate(const AtlasShape& shape, const glm::ivec2& target) {
  if (irradiance_ && shape == shape_ && irradiance_.width() == target.x && irradiance_.height() == target.y) return;
  shape_ = shape;
  const glm::ivec2 size = atlasSize(shape.base, shape.coarsest);
  const auto make = [](const char* label, const glm::ivec2& texels, int levels = 1) {
    return gl::Texture(label, {.format = GL_RGBA32F, .width = texels.x, .height = texels.y, .levels = levels});
  };
  stencil_ = gl::Texture("multires/stencil", {.format = GL_DEPTH24_STENCIL8, .width = size.x, .height = size.y});
  atlas_ = make("multires/atlas", size);
  irradiance_ = make("multires/irradiance", target);
  levels_ = shape.coarsest > 0 ? make("multires/levels", shape.base / 2, shape.coarsest) : gl::Texture();
  for (gl::Texture* t : {&atlasGlossy_, &levelsGlossy_, &glossy_}) *t = {};
  if (shape.glossy) {
    atlasGlossy_ = make("multires/glossy atlas", size);
    glossy_ = make("multires/glossy", target);
    if (shape.coarsest > 0) levelsGlossy_ = make("multires/glossy levels", shape.base / 2, shape.coarsest);
  }
  atlasFramebuffer_ = shape.glossy ? gl::Framebuffer("multires atlas", {&atlas_, &atlasGlossy_}, &stencil_)
                                   : gl::Framebuffer("multires atlas", {&atlas_}, &stencil_);
  stencilFramebuffer_ = gl::Framebuffer("multires stencil", {}, &stencil_);
  framebuffer_ = framebufferOf("multires irradiance", irradiance_, glossy_);
  levelFramebuffers_.clear();
  for (int i = 0; i < shape.coarsest; ++i)
    levelFramebuffers_.push_back(shape.glossy
                                     ? gl::Framebuffer("multires level", {&levels_, &levelsGlossy_}, nullptr, i)
                                     : gl::Framebuffer("multires level", {&levels_}, nullptr, i));
}

/// Sets the stencil where a patch gathers.
void MultiresPass::mark(const MultiresInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Stencil);
  stencilFramebuffer_.bind();
  gl::PipelineState{.stencil = gl::Stencil::Mark, .width = stencil_.width(), .height = stencil_.height()}.apply();
  const GLint zero = 0;
  glClearNamedFramebufferiv(stencilFramebuffer_.name(), GL_STENCIL, 0, &zero);
  const gl::Program& program = context_.programs.get({.fragment = "refine.frag"});
  program.use();
  program.set("base", shape_.base);
  program.set("coarsest", shape_.coarsest);
  program.set("grid", shape_.grid);
  program.set("gridLevel", shape_.gridLevel());
  program.set("size", glm::ivec2(in.gbuffer.width, in.gbuffer.height));
  in.gbuffer.depth->bind(0);
  if (pyramid_.plane) {
    pyramid_.plane->bind(1);
    pyramid_.normalLo->bind(2);
  }
  if (!marks_) marks_ = gl::Query(GL_SAMPLES_PASSED);
  glBeginQuery(GL_SAMPLES_PASSED, marks_.name());
  gl::drawFullscreen();
  glEndQuery(GL_SAMPLES_PASSED);
}

uint64_t MultiresPass::patchesMarked() {
  if (marks_) glGetQueryObjectui64v(marks_.name(), GL_QUERY_RESULT_NO_WAIT, &marked_); // untouched if not yet known
  return marked_;
}

void MultiresPass::clear(const MultiresInputs& in) {
  gl::PipelineState{.width = atlas_.width(), .height = atlas_.height()}.apply(); // clearing keeps to the scissor
  const float nothing[4] = {};
  for (int i = 0; i < (in.gbuffer.finish ? 2 : 1); ++i)
    glClearNamedFramebufferfv(atlasFramebuffer_.name(), GL_COLOR, i, nothing);
}

GatherDraw MultiresPass::drawOf(const MultiresInputs& in) const {
  return {.gbuffer = in.gbuffer,
          .lights = in.lights,
          .maps = in.maps,
          .smoothShadows = nullptr,
          .areas = {},
          .grid = shape_.grid,
          .patches = true,
          .addToTarget = true,
          .biasTexels = in.bias,
          .diskFactor = in.gather.disk / kPi,
          .largestG = in.gather.clamp > 0 ? in.gather.clamp : kInfinity,
          .spread = in.gather.spread,
          .trees = in.trees};
}

/// Each VPL into patches of its own. What of a texel's light came from which patches is known only while one VPL is
/// looked at, so each is made whole by itself.
void MultiresPass::splatEach(const MultiresInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::SplatPerVpl);
  const GatherDraw draw = drawOf(in);
  const SplatInputs splats{draw, pyramid_, shape_, in.multires.light};
  framebuffer_.bind();
  gl::PipelineState{.width = irradiance_.width(), .height = irradiance_.height()}.apply();
  const float nothing[4] = {};
  for (int i = 0; i < (in.gbuffer.finish ? 2 : 1); ++i)
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, i, nothing);
  for (uint32_t slot = 0; slot < in.lights.count; ++slot) {
    splatPass_.refineFor(splats, slot);
    clear(in);
    splatPass_.splatOne(splats, atlasFramebuffer_, slot);
    upsample(in, true);
  }
}

void MultiresPass::gather(const MultiresInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Gather);
  clear(in);
  std::vector<GatherArea> areas;
  for (int level = 0; level <= shape_.coarsest; ++level) {
    const glm::ivec2 sub = shape_.sub(level);
    for (int c = 0; c < shape_.grid * shape_.grid; ++c) {
      const glm::ivec2 subset(c % shape_.grid, c / shape_.grid);
      areas.push_back(
          {.origin = atlasOrigin(shape_.base, level) + subset * sub, .size = sub, .subset = subset, .level = level});
    }
  }
  GatherDraw draw = drawOf(in);
  draw.areas = areas;
  drawGather(context_.programs, atlasFramebuffer_, draw);
}

/// From the atlas to the pixels; `add`: to what they hold.
void MultiresPass::upsample(const MultiresInputs& in, bool add) {
  std::optional<gl::PassScope> scope;
  if (!add) scope.emplace(context_.profiler, key(StageId::Upsample)); // else part of a row that has begun
  in.gbuffer.camera->bindUniform(0);
  in.gbuffer.depth->bind(0);
  in.gbuffer.normal->bind(1);
  atlas_.bind(2);
  if (shape_.glossy) atlasGlossy_.bind(4);
  for (int level = shape_.coarsest; level >= 0; --level) {
    gl::ProgramDesc desc{.fragment = "upsample.frag", .defines = bindReceivers(in.gbuffer)};
    if (level == 0) desc.defines.push_back("FINAL");
    const gl::Program& program = context_.programs.get(desc);
    program.use();
    program.set("base", shape_.base);
    program.set("level", level);
    program.set("coarsest", shape_.coarsest);
    program.set("grid", shape_.grid);
    program.set("tile", shape_.grid == 4 ? tileSize(in.gbuffer) : glm::ivec2(in.gbuffer.width, in.gbuffer.height));
    program.set("normalPower", in.filter.normalPower);
    program.set("distanceSigma", in.filter.distance);
    program.set("detail", in.multires.detail);
    if (level < shape_.coarsest) {
      levels_.limitLevels(level, level); // level + 1 of the atlas
      levels_.bind(3);
      if (shape_.glossy) {
        levelsGlossy_.limitLevels(level, level);
        levelsGlossy_.bind(5);
      }
    }
    const gl::Texture& target = level == 0 ? irradiance_ : levels_;
    const int shift = level == 0 ? 0 : level - 1;
    (level == 0 ? framebuffer_ : levelFramebuffers_[shift]).bind();
    gl::PipelineState{.add = add && level == 0, .width = target.width() >> shift, .height = target.height() >> shift}
        .apply();
    gl::drawFullscreen();
  }
}

uint64_t MultiresPass::countPatches() const {
  std::vector<vec4> texels(size_t(atlas_.width()) * atlas_.height());
  glGetTextureImage(atlas_.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(vec4)), texels.data());
  return uint64_t(std::count_if(texels.begin(), texels.end(), [](const vec4& t) { return t.a > 0; }));
}

} // namespace lambent
