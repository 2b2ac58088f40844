// From gathered subsets to irradiance at every pixel. Paper 1, section 4.5: cross-bilateral filter over normals and
// positions. Our kernel is a tent of 7×7 (theirs a box), so that all 16 subsets weigh the same at every pixel.
#include "gi/render/gather.h"

#include <algorithm>

namespace lambent {

IndirectLight FilterPass::run(const FilterInputs& in) {
  // A full gather has nothing to mix: every pixel has seen every light.
  if (!in.raw.deinterleaved)
    return {in.raw.irradiance};
  const gl::PassScope scope(context_.profiler, "filter");
  const int width = in.gbuffer.width, height = in.gbuffer.height;
  if (!irradiance_ || irradiance_.width() != width || irradiance_.height() != height) {
    irradiance_ = gl::Texture("filter/irradiance", {.format = GL_RGBA32F, .width = width, .height = height});
    framebuffer_ = gl::Framebuffer("filter", {&irradiance_});
  }
  gl::ProgramDesc desc{.fragment = "filter.frag"};
  if (in.filter.on)
    desc.defines.push_back("FILTER");
  const gl::Program& program = context_.programs.get(desc);
  program.use();
  program.set("tileSize", tileSize(in.gbuffer));
  program.set("normalPower", in.filter.normalPower);
  program.set("distanceSigma", in.filter.distance);
  in.gbuffer.camera->bindUniform(0);
  in.gbuffer.depth->bind(0);
  in.gbuffer.normal->bind(1);
  in.raw.irradiance->bind(2);
  framebuffer_.bind();
  gl::PipelineState{.width = width, .height = height}.apply();
  gl::drawFullscreen();
  return {&irradiance_};
}

IndirectLight IndirectUpload::run(const Image& image) {
  const gl::PassScope scope(context_.profiler, "irradiance upload");
  if (!irradiance_ || irradiance_.width() != image.width || irradiance_.height() != image.height)
    irradiance_ =
        gl::Texture("irradiance upload/image", {.format = GL_RGBA32F, .width = image.width, .height = image.height});
  std::vector<vec3> bottomUp(image.pixels.size());
  for (int y = 0; y < image.height; ++y)
    std::copy_n(&image.pixels[size_t(y) * image.width], image.width,
                &bottomUp[size_t(image.height - 1 - y) * image.width]);
  glTextureSubImage2D(irradiance_.name(), 0, 0, 0, image.width, image.height, GL_RGB, GL_FLOAT, bottomUp.data());
  return {&irradiance_};
}

} // namespace lambent
