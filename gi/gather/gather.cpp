// Indirect irradiance from VPLs. Paper 1, section 4.5: interleaved sampling, each pixel of a 4×4 block reads one of 16
// subsets. We draw the pixels of a subset side by side (de-interleaved): every fragment of a draw then runs the same
// lights, 10–25 % faster on software Mesa and kinder to GPU caches.
#include "gi/gather/gather.h"

#include "engine/core/error.h"

#include <algorithm>

namespace lambent {

glm::ivec2 tileSize(const GBuffer& gbuffer) { return {(gbuffer.width + 3) / 4, (gbuffer.height + 3) / 4}; }

std::vector<GatherArea> gatherAreas(const GBuffer& gbuffer, int grid) {
  if (grid == 1) return {{.origin = {0, 0}, .size = {gbuffer.width, gbuffer.height}}};
  std::vector<GatherArea> areas;
  const glm::ivec2 tile = tileSize(gbuffer);
  for (int c = 0; c < kLightClasses; ++c) {
    const glm::ivec2 subset(c % grid, c / grid);
    areas.push_back({.origin = subset * tile, .size = tile, .subset = subset});
  }
  return areas;
}

std::vector<std::string> bindReceivers(const GBuffer& gbuffer) {
  if (!gbuffer.finish) return {};
  gbuffer.albedo->bind(6);
  gbuffer.finish->bind(7);
  return {"GLOSSY"};
}

bool fitGlossy(gl::Texture& texture, const char* label, const GBuffer& gbuffer, const glm::ivec2& size) {
  if (!gbuffer.finish) {
    const bool had = bool(texture);
    texture = {};
    return had;
  }
  if (texture && texture.width() == size.x && texture.height() == size.y) return false;
  texture = gl::Texture(label, {.format = GL_RGBA32F, .width = size.x, .height = size.y});
  return true;
}

gl::Framebuffer framebufferOf(const char* label, const gl::Texture& irradiance, const gl::Texture& glossy) {
  return glossy ? gl::Framebuffer(label, {&irradiance, &glossy}) : gl::Framebuffer(label, {&irradiance});
}

const gl::Texture* orNull(const gl::Texture& texture) { return texture ? &texture : nullptr; }

void drawGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in) {
  if (in.trees) {
    drawTreeGather(programs, target, in);
    return;
  }
  gl::ProgramDesc desc{.fragment = "gather.frag", .defines = bindReceivers(in.gbuffer)};
  if (in.patches) desc.defines.push_back("PATCHES");
  if (in.maps) desc.defines.push_back("SHADOWS");
  if (in.maps && in.smoothShadows) desc.defines.push_back("SMOOTH_SHADOWS");
  const gl::Program& program = programs.get(desc);
  program.use();
  program.set("diskFactor", in.diskFactor);
  program.set("largestG", in.largestG);
  program.set("spread", in.spread);
  if (in.maps) {
    program.set("farDistance", in.maps->farDistance);
    program.set("mapResolution", float(in.maps->resolution));
    program.set("biasTexels", in.biasTexels);
  }
  const bool subsets = in.grid > 1;
  program.set("stride", in.grid);
  program.set("classCount", subsets ? 1 : kClassesPerLightBlock);
  program.set("scale", subsets ? float(kLightClasses) : 1.0f);
  in.gbuffer.camera->bindUniform(0);
  in.gbuffer.depth->bind(0);
  in.gbuffer.normal->bind(1);
  target.bind();
  glBindSampler(2, in.smoothShadows ? in.smoothShadows->name() : 0);

  constexpr uint32_t kChunk = kLightClasses * kLightsPerClass;
  constexpr uint64_t kBlockBytes = kClassesPerLightBlock * kLightsPerClass * sizeof(VplLight);
  const uint32_t chunks = std::max(1u, (in.lights.count + kChunk - 1) / kChunk);
  for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
    const uint32_t lights = std::min(kChunk, in.lights.count - chunk * kChunk);
    program.set("perClass", int((lights + kLightClasses - 1) / kLightClasses));
    if (in.maps && lights > 0) {
      CHECK_LT(chunk, in.maps->arrays.size());
      in.maps->arrays[chunk].bind(2);
    }
    for (int block = 0; block < kLightClasses / kClassesPerLightBlock; ++block) {
      in.lights.buffer->bindUniform(1, (uint64_t(chunk) * 2 + block) * kBlockBytes, kBlockBytes);
      program.set("blockClass", block * kClassesPerLightBlock);
      for (const GatherArea& area : in.areas) {
        const int lightClass = area.subset.x + 4 * area.subset.y;
        if (subsets && lightClass / kClassesPerLightBlock != block) continue;
        program.set("firstClass", subsets ? lightClass % kClassesPerLightBlock : 0);
        program.set("subset", area.subset);
        program.set("tileOrigin", area.origin);
        program.set("level", area.level);
        gl::PipelineState{.add = in.addToTarget || chunk > 0 || (!subsets && block > 0),
                          .stencil = in.patches ? gl::Stencil::Marked : gl::Stencil::Off,
                          .x = area.origin.x,
                          .y = area.origin.y,
                          .width = area.size.x,
                          .height = area.size.y}
            .apply();
        gl::drawFullscreen();
      }
    }
  }
  glBindSampler(2, 0);
}

RawIndirect GatherPass::run(const GatherInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Gather);
  const bool deinterleaved = interleaved(in.gather.mode);
  const glm::ivec2 tile = tileSize(in.gbuffer);
  const glm::ivec2 size = deinterleaved ? 4 * tile : glm::ivec2(in.gbuffer.width, in.gbuffer.height);
  bool resized = fitGlossy(glossy_, "gather/glossy", in.gbuffer, size);
  if (!irradiance_ || irradiance_.width() != size.x || irradiance_.height() != size.y) {
    irradiance_ = gl::Texture("gather/irradiance", {.format = GL_RGBA32F, .width = size.x, .height = size.y});
    resized = true;
  }
  if (resized) framebuffer_ = framebufferOf("gather", irradiance_, glossy_);
  drawGather(context_.programs, framebuffer_,
             {.gbuffer = in.gbuffer,
              .lights = in.lights,
              .maps = in.maps,
              .smoothShadows = nullptr,
              .areas = gatherAreas(in.gbuffer, deinterleaved ? 4 : 1),
              .grid = deinterleaved ? 4 : 1,
              .patches = false,
              .addToTarget = false,
              .biasTexels = in.bias,
              .diskFactor = in.gather.disk / kPi,
              .largestG = in.gather.clamp > 0 ? in.gather.clamp : kInfinity,
              .spread = in.gather.spread,

              .trees = in.trees});
  return {&irradiance_, deinterleaved, orNull(glossy_)};
}

} // namespace lambent
