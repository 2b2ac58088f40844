// Direct irradiance at the visible surfaces: punctual lights and the sky block by block, then emissive samples.
#include "gi/direct/light_shadows.h"
#include "gi/gather/gather.h"

namespace lambent {

DirectPass::DirectPass(PassContext context) : context_(context), compareSampler_("direct/compare") {
  const GLuint sampler = compareSampler_.name();
  glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL); // lit where reference ≤ stored
}

DirectLight DirectPass::run(const DirectInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Direct);
  const int width = in.gbuffer.width, height = in.gbuffer.height;
  bool resized = fitGlossy(glossy_, "direct/glossy", in.gbuffer, {width, height});
  if (!irradiance_ || irradiance_.width() != width || irradiance_.height() != height) {
    irradiance_ = gl::Texture("direct/irradiance", {.format = GL_RGBA32F, .width = width, .height = height});
    resized = true;
  }
  if (resized) framebuffer_ = framebufferOf("direct", irradiance_, glossy_);
  framebuffer_.bind();
  gl::PipelineState{.add = true, .width = width, .height = height}.apply();
  const float black[4] = {0, 0, 0, 0};
  for (int i = 0; i < (glossy_ ? 2 : 1); ++i) glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, i, black);
  in.gbuffer.camera->bindUniform(0);
  in.gbuffer.depth->bind(0);
  in.gbuffer.normal->bind(1);
  for (const LightBlock& block : in.shadows.blocks) {
    const char* kind = block.kind == LightKind::Cube   ? "CUBE_MAPS"
                       : block.kind == LightKind::Spot ? "SPOT_MAPS"
                                                       : "SUN_MAPS";
    std::vector<std::string> defines = bindReceivers(in.gbuffer);
    defines.push_back(kind);
    const gl::Program& program = context_.programs.get({.fragment = "direct.frag", .defines = std::move(defines)});
    program.use();
    program.set("lightCount", block.count);
    block.lights.bindUniform(1);
    block.maps.bind(2);
    gl::drawFullscreen();
  }
  if (in.emitters && in.emitters->count > 0)
    drawGather(context_.programs, framebuffer_,
               {.gbuffer = in.gbuffer,
                .lights = *in.emitters,
                .maps = in.emitterMaps,
                .smoothShadows = &compareSampler_,
                .areas = gatherAreas(in.gbuffer, 1),
                .grid = 1,
                .patches = false,
                .addToTarget = true,
                // Bilinear comparison reaches half a texel farther.
                .biasTexels = 1.5f * in.shadow.bias,
                .diskFactor = 1 / kPi,
                .largestG = kInfinity,
                .spread = GatherSettings{}.spread});
  return {&irradiance_, orNull(glossy_)};
}

} // namespace lambent
