// From gathered subsets to irradiance at every pixel. Paper 1, section 4.5: cross-bilateral filter over normals and
// positions. Our kernel is a tent of 7×7 (theirs a box), so that all 16 subsets weigh the same at every pixel. By
// default it goes along rows, then columns: a bilateral kernel is not quite separable, so the whole one stays as a
// setting (costs and errors of both: gi/README.md).
#include "gi/gather/gather.h"

#include <algorithm>

namespace lambent {

IndirectLight FilterPass::run(const FilterInputs& in) {
  // A full gather has nothing to mix: every pixel has seen every light.
  if (!in.raw.deinterleaved) return {in.raw.irradiance, in.raw.glossy};
  const gl::PassScope scope = context_.scope(StageId::Filter);
  const int width = in.gbuffer.width, height = in.gbuffer.height;
  bool resized = fitGlossy(glossy_, "filter/glossy", in.gbuffer, {width, height});
  fitGlossy(glossyRows_, "filter/glossy rows", in.gbuffer, {width, height});
  if (!irradiance_ || irradiance_.width() != width || irradiance_.height() != height) {
    irradiance_ = gl::Texture("filter/irradiance", {.format = GL_RGBA32F, .width = width, .height = height});
    rows_ = gl::Texture("filter/rows", {.format = GL_RGBA32F, .width = width, .height = height});
    resized = true;
  }
  if (resized) {
    framebuffer_ = framebufferOf("filter", irradiance_, glossy_);
    rowsFramebuffer_ = framebufferOf("filter rows", rows_, glossyRows_);
  }
  in.gbuffer.camera->bindUniform(0);
  in.gbuffer.depth->bind(0);
  in.gbuffer.normal->bind(1);
  const auto draw = [&](const gl::Texture& source, const gl::Texture* glossy, std::vector<std::string> defines,
                        const glm::ivec2& reach, const gl::Framebuffer& target) {
    if (glossy) {
      glossy->bind(3);
      in.gbuffer.finish->bind(7);
      defines.push_back("GLOSSY");
    }
    const gl::Program& program = context_.programs.get({.fragment = "filter.frag", .defines = std::move(defines)});
    program.use();
    program.set("tileSize", tileSize(in.gbuffer));
    program.set("reach", reach);
    program.set("normalPower", in.filter.normalPower);
    program.set("distanceSigma", in.filter.distance);
    source.bind(2);
    target.bind();
    gl::PipelineState{.width = width, .height = height}.apply();
    gl::drawFullscreen();
  };
  if (!in.filter.on) {
    draw(*in.raw.irradiance, in.raw.glossy, {"SUBSETS"}, {0, 0}, framebuffer_);
  } else if (in.filter.kernel == FilterKernel::Whole) {
    draw(*in.raw.irradiance, in.raw.glossy, {"SUBSETS", "FILTER"}, {3, 3}, framebuffer_);
  } else {
    draw(*in.raw.irradiance, in.raw.glossy, {"SUBSETS", "FILTER"}, {3, 0}, rowsFramebuffer_);
    draw(rows_, orNull(glossyRows_), {"FILTER"}, {0, 3}, framebuffer_);
  }
  return {&irradiance_, orNull(glossy_)};
}

IndirectLight IndirectUpload::run(const Image& irradiance, const Image* glossy) {
  const gl::PassScope scope = context_.scope(StageId::IrradianceUpload);
  const auto upload = [](gl::Texture& texture, const char* label, const Image& image) {
    if (!texture || texture.width() != image.width || texture.height() != image.height)
      texture = gl::Texture(label, {.format = GL_RGBA32F, .width = image.width, .height = image.height});
    std::vector<vec3> bottomUp(image.pixels.size());
    for (int y = 0; y < image.height; ++y)
      std::copy_n(&image.pixels[size_t(y) * image.width], image.width,
                  &bottomUp[size_t(image.height - 1 - y) * image.width]);
    glTextureSubImage2D(texture.name(), 0, 0, 0, image.width, image.height, GL_RGB, GL_FLOAT, bottomUp.data());
    return &texture;
  };
  return {upload(irradiance_, "irradiance upload/image", irradiance),
          glossy ? upload(glossy_, "irradiance upload/glossy", *glossy) : nullptr};
}

} // namespace lambent
