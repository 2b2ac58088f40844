// Multiresolution splatting (paper 2, sections 3.3, 3.4 and 4.1).
#include "gi/gather/splat.h"

#include "engine/core/error.h"
#include "shaders/shared/patches.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr uint64_t kBlockBytes = kClassesPerLightBlock * kLightsPerClass * sizeof(VplLight);

/// Variant of vpl_shading.glsl, and its textures and numbers.
std::vector<std::string> shadingDefines(const GatherDraw& draw) {
  std::vector<std::string> defines = bindSurfaces(draw.surfaces);
  if (draw.lights.maps) defines.push_back("SHADOWS");
  return defines;
}

/// Where a slot's light lies: shaders/shared/vpl_light.h.
struct LightPlace {
  uint32_t chunk;
  int block, light, layer; // block of the chunk, light of the block

  explicit LightPlace(uint32_t slot)
      : chunk(slot / kLightsPerChunk), block(int(slot % kLightClasses) / kClassesPerLightBlock),
        light(int(slot % kLightClasses) % kClassesPerLightBlock * kLightsPerClass +
              int(slot % kLightsPerChunk) / kLightClasses),
        layer(int(slot % kLightsPerChunk)) {}
};

void bindLights(const GatherDraw& draw, uint32_t chunk, int block) {
  draw.lights.list.packed.buffer->bindUniform(1, (uint64_t(chunk) * 2 + block) * kBlockBytes, kBlockBytes);
  if (!draw.lights.maps) return;
  CHECK_LT(chunk, draw.lights.maps->arrays.size());
  draw.lights.maps->arrays[chunk].bind(2);
}

} // namespace

void SplatPass::refine(const SplatInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Refine);
  bindSurfaces(in.draw.surfaces);
  const auto program = [&](std::vector<std::string> defines) -> const gl::Program& {
    return context_.programs.get({.vertex = "splat_refine.vert",
                                  .defines = std::move(defines),
                                  .geometry = "splat_refine.geom",
                                  .captured = {"patchOut"}});
  };
  refineList(in, program({"FIRST"}), program({}));
}

void SplatPass::refineFor(const SplatInputs& in, uint32_t slot) {
  bindSurfaces(in.draw.surfaces);
  const LightPlace place(slot);
  bindLights(in.draw, place.chunk, place.block);
  const auto program = [&](bool first) -> const gl::Program& {
    std::vector<std::string> defines = shadingDefines(in.draw);
    defines.push_back("PER_VPL");
    if (first) defines.push_back("FIRST");
    const gl::Program& p = context_.programs.get({.vertex = "splat_refine.vert",
                                                  .defines = std::move(defines),
                                                  .geometry = "splat_refine.geom",
                                                  .captured = {"patchOut"}});
    setShading(p, in.draw);
    p.set("light", place.light);
    p.set("layer", place.layer);
    p.set("lightThreshold", in.lightThreshold);
    return p;
  };
  refineList(in, program(true), program(false));
}

void SplatPass::refineList(const SplatInputs& in, const gl::Program& first, const gl::Program& next) {
  const uint64_t bytes = uint64_t(in.shape.base.x) * in.shape.base.y * sizeof(glm::ivec3); // as many as pixels
  if (!lists_[0] || lists_[0].bytes() != bytes) {
    for (int i = 0; i < 2; ++i) {
      lists_[i] = gl::Buffer("multires/subsplats", bytes, nullptr);
      feedbacks_[i] = gl::TransformFeedback("subsplats", lists_[i]);
      arrays_[i] = gl::VertexArray("multires/subsplats");
      const GLuint array = arrays_[i].name();
      glVertexArrayVertexBuffer(array, 0, lists_[i].name(), 0, sizeof(glm::ivec3));
      glEnableVertexArrayAttrib(array, 0);
      glVertexArrayAttribIFormat(array, 0, 3, GL_INT, 0);
      glVertexArrayAttribBinding(array, 0, 0);
    }
  }
  if (in.patches.plane) {
    in.patches.plane->bind(3);
    in.patches.normalLo->bind(4);
  }
  const glm::ivec2 side = in.shape.sub(in.shape.coarsest);
  glEnable(GL_RASTERIZER_DISCARD);
  for (int level = in.shape.coarsest; level >= std::min(1, in.shape.coarsest); --level) {
    const bool begin = level == in.shape.coarsest;
    const gl::Program& program = begin ? first : next;
    program.set("side", side);
    program.set("coarsest", in.shape.coarsest);
    program.set("level", level);
    program.use();
    const int from = list_;
    list_ = 1 - list_;
    glBindVertexArray(arrays_[from].name());
    feedbacks_[list_].bind();
    glBeginTransformFeedback(GL_POINTS);
    if (begin)
      gl::drawArrays(GL_POINTS, side.x * side.y);
    else
      gl::drawFeedback(GL_POINTS, feedbacks_[from]);
    glEndTransformFeedback();
    gl::TransformFeedback::unbind();
  }
  glBindVertexArray(0);
  glDisable(GL_RASTERIZER_DISCARD);
}

void SplatPass::splat(const SplatInputs& in, const gl::Framebuffer& atlas) {
  const gl::PassScope scope = context_.scope(StageId::Splat);
  const PackedLights& lights = in.draw.lights.list.packed;
  for (uint32_t chunk = 0; chunk * kLightsPerChunk < lights.count; ++chunk) {
    const int perClass = lightsPerClass(lights, chunk);
    for (int block = 0; block < kLightClasses / kClassesPerLightBlock; ++block)
      drawPoints(in, atlas, chunk, block, 0, perClass * kClassesPerLightBlock);
  }
}

void SplatPass::splatOne(const SplatInputs& in, const gl::Framebuffer& atlas, uint32_t slot) {
  const LightPlace place(slot);
  const int perClass = lightsPerClass(in.draw.lights.list.packed, place.chunk);
  const int index = place.light / kLightsPerClass * perClass + place.light % kLightsPerClass;
  drawPoints(in, atlas, place.chunk, place.block, index, 1);
}

void SplatPass::drawPoints(const SplatInputs& in, const gl::Framebuffer& atlas, uint32_t chunk, int block,
                           int firstLight, int lights) {
  const gl::Program& program =
      context_.programs.get({.vertex = "splat.vert", .fragment = "splat.frag", .defines = shadingDefines(in.draw)});
  setShading(program, in.draw);
  const glm::ivec2 size = atlasSize(in.shape.base, in.shape.coarsest);
  program.set("base", in.shape.base);
  program.set("inverseSize", 1.0f / vec2(size));
  program.set("perClass", lightsPerClass(in.draw.lights.list.packed, chunk));
  program.set("firstLight", firstLight);
  program.set("blockClass", block * kClassesPerLightBlock);
  program.use();
  bindSurfaces(in.draw.surfaces);
  bindLights(in.draw, chunk, block);
  atlas.bind();
  gl::PipelineState{.add = true, .width = size.x, .height = size.y}.apply();
  glBindVertexArray(arrays_[list_].name());
  gl::drawFeedback(GL_POINTS, feedbacks_[list_], lights);
  glBindVertexArray(0);
}

} // namespace lambent
