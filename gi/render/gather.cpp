// Indirect irradiance from VPLs. Paper 1, section 4.5: interleaved sampling, each pixel of a 4×4 block reads one of 16
// subsets. We draw the pixels of a subset side by side (de-interleaved): every fragment of a draw then runs the same
// lights, 10–25 % faster on software Mesa and kinder to GPU caches.
#include "gi/render/gather.h"

#include "engine/core/error.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr uint32_t kChunk = 2048, kClasses = 16;

} // namespace

glm::ivec2 tileSize(const GBuffer& gbuffer) { return {(gbuffer.width + 3) / 4, (gbuffer.height + 3) / 4}; }

void drawGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in) {
  gl::ProgramDesc desc{.fragment = "gather.frag"};
  if (in.maps) desc.defines.push_back("SHADOWS");
  if (in.maps && in.smoothShadows) desc.defines.push_back("SMOOTH_SHADOWS");
  const gl::Program& program = programs.get(desc);
  program.use();
  program.set("diskFactor", in.diskFactor);
  program.set("largestG", in.largestG);
  program.set("biasTexels", in.biasTexels);
  program.set("farDistance", in.maps ? in.maps->farDistance : 1.0f);
  program.set("stride", in.deinterleaved ? 4 : 1);
  program.set("classCount", in.deinterleaved ? 1 : int(kClasses));
  program.set("scale", in.deinterleaved ? float(kClasses) : 1.0f);
  in.gbuffer.camera->bindUniform(0);
  in.gbuffer.depth->bind(0);
  in.gbuffer.normal->bind(1);
  target.bind();
  glBindSampler(2, in.smoothShadows ? in.smoothShadows->name() : 0);

  const glm::ivec2 tile = tileSize(in.gbuffer);
  const uint32_t chunks = std::max(1u, (in.lights.count + kChunk - 1) / kChunk);
  for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
    const uint32_t lights = std::min(kChunk, in.lights.count - chunk * kChunk);
    program.set("perClass", int((lights + kClasses - 1) / kClasses));
    in.lights.buffer->bindUniform(1, chunk * kChunk * sizeof(VplLight), kChunk * sizeof(VplLight));
    if (in.maps && lights > 0) {
      CHECK_LT(chunk, in.maps->arrays.size());
      in.maps->arrays[chunk].bind(2);
    }
    const bool add = in.addToTarget || chunk > 0;
    for (int c = 0; c < (in.deinterleaved ? int(kClasses) : 1); ++c) {
      const glm::ivec2 subset(c % 4, c / 4);
      program.set("firstClass", c);
      program.set("subset", subset);
      program.set("tileOrigin", in.deinterleaved ? subset * tile : glm::ivec2(0));
      if (in.deinterleaved)
        gl::PipelineState{.add = add, .x = subset.x * tile.x, .y = subset.y * tile.y, .width = tile.x, .height = tile.y}
            .apply();
      else
        gl::PipelineState{.add = add, .width = in.gbuffer.width, .height = in.gbuffer.height}.apply();
      gl::drawFullscreen();
    }
  }
  glBindSampler(2, 0);
}

RawIndirect GatherPass::run(const GatherInputs& in) {
  const gl::PassScope scope(context_.profiler, "gather");
  const bool deinterleaved = in.gather.mode == GatherMode::Interleaved;
  const glm::ivec2 tile = tileSize(in.gbuffer);
  const glm::ivec2 size = deinterleaved ? 4 * tile : glm::ivec2(in.gbuffer.width, in.gbuffer.height);
  if (!irradiance_ || irradiance_.width() != size.x || irradiance_.height() != size.y) {
    irradiance_ = gl::Texture("gather/irradiance", {.format = GL_RGBA32F, .width = size.x, .height = size.y});
    framebuffer_ = gl::Framebuffer("gather", {&irradiance_});
  }
  drawGather(context_.programs, framebuffer_,
             {.gbuffer = in.gbuffer,
              .lights = in.lights,
              .maps = in.maps,
              .smoothShadows = nullptr,
              .deinterleaved = deinterleaved,
              .addToTarget = false,
              .biasTexels = in.bias,
              .diskFactor = in.gather.disk ? 1 / kPi : 0.0f,
              .largestG = in.gather.clamp > 0 ? in.gather.clamp : kInfinity});
  return {&irradiance_, deinterleaved};
}

} // namespace lambent
