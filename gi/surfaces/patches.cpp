// Which patches of the image hold one smooth surface. Papers 2 and 3 compare depths in a min-max pyramid, which fires
// on floors seen at a grazing angle (paper 2 says so), or their derivatives. Here a patch keeps a plane and a bound of
// the distance to it, merged from its parts: no plane ever fires, no step is missed; the papers' range of depths is
// there for comparison. Normals are ranges, as in paper 2, 3.2.
#include "gi/surfaces/surfaces.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lambent {

PatchPyramid PatchPass::run(const PatchInputs& in) {
  const gl::PassScope scope = context_.scope(stage_);
  const int multiple = 1 << in.levels;
  const glm::ivec2 padded = (in.size + multiple - 1) / multiple * multiple;
  if (in.levels == 0) return {.padded = padded};
  const glm::ivec2 half = padded / 2;
  if (!plane_ || plane_.width() != half.x || plane_.height() != half.y || plane_.desc().levels != in.levels) {
    const auto make = [&](const char* what, GLenum format) {
      return gl::Texture(name_ + "/" + what,
                         {.format = format, .width = half.x, .height = half.y, .levels = in.levels});
    };
    plane_ = make("planes", GL_RGBA32F);
    normalLo_ = make("least normals", GL_RGBA16F);
    normalHi_ = make("largest normals", GL_RGBA16F);
    framebuffers_.clear();
    for (int i = 0; i < in.levels; ++i)
      framebuffers_.emplace_back(name_, std::initializer_list<const gl::Texture*>{&plane_, &normalLo_, &normalHi_},
                                 nullptr, i);
  }
  const glm::ivec2 cell = in.cell == in.size ? padded : in.cell; // an image is one cell
  const int finest = std::clamp(int(std::bit_width(unsigned(in.finest))) - 1, 0, in.levels);
  for (int i = 0; i < in.levels; ++i) {
    std::vector<std::string> defines;
    if (i == 0) defines.push_back("FIRST");
    if (in.criterion == PatchCriterion::Depth) defines.push_back("DEPTH_RANGE");
    const gl::Program& program = context_.programs.get({.fragment = "pyramid.frag", .defines = std::move(defines)});
    program.use();
    program.set("size", in.size);
    program.set("cell", cell / (1 << i));
    program.set("childPixels", 1 << i);
    program.set("mayBeSplit", i + 1 > finest ? 1 : 0);
    program.set("depthThreshold", in.depthThreshold);
    program.set("normalThreshold", in.normalThreshold);
    program.set("orthoScale", in.orthoScale);
    program.set("orthoFrom", in.orthoFrom);
    program.set("columns", in.size.x / in.cell.x);
    program.set("balance", in.balance ? 1 : 0);
    program.set("edges", in.edges ? 1 : 0);
    if (i == 0) {
      in.depth.bind(0);
      in.normal.bind(1);
    } else {
      int unit = 0;
      for (const gl::Texture* t : {&plane_, &normalLo_, &normalHi_}) {
        t->limitLevels(i - 1, i - 1);
        t->bind(unit++);
      }
    }
    framebuffers_[i].bind();
    gl::PipelineState{.width = half.x >> i, .height = half.y >> i}.apply();
    gl::drawFullscreen();
  }
  for (const gl::Texture* t : {&plane_, &normalLo_, &normalHi_}) t->limitLevels(0, in.levels - 1);
  return {&plane_, &normalLo_, &normalHi_, in.levels, finest, padded};
}

PatchPyramid PatchPass::run(const GBuffer& surfaces, const MultiresSettings& settings) {
  const float longer = float(std::max(surfaces.width, surfaces.height));
  const CameraBlock& camera = surfaces.block;
  const bool ortho = camera.lens.w > 0;
  return run({.depth = *surfaces.depth,
              .normal = *surfaces.normal,
              .size = {surfaces.width, surfaces.height},
              .cell = {surfaces.width, surfaces.height},
              .levels = std::clamp(int(std::lround(std::log2(longer / float(settings.coarsest)))), 0, 10),
              .orthoScale = ortho ? (camera.lens.w - camera.lens.z) / camera.lens.y : 0,
              .orthoFrom = ortho ? 0 : 1,
              .criterion = settings.criterion,
              .finest = settings.finest,
              .depthThreshold = settings.depth,
              .normalThreshold = settings.normal,
              .balance = settings.balance,
              .edges = settings.edges});
}

} // namespace lambent
