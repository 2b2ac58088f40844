// The image from its parts, and the exposure that suits it.
#include "engine/image/exposure.h"
#include "gi/gather/draw_gather.h"
#include "gi/viewer/viewer_stages.h"

#include <cmath>
#include <utility>

namespace lambent {

const gl::Texture& CompositePass::run(const CompositeInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Composite);
  const int width = in.surfaces.width, height = in.surfaces.height;
  if (!black_) {
    black_ = gl::Texture("composite/black", {.format = GL_RGBA32F});
    black_.clear();
  }
  if (!radiance_ || radiance_.width() != width || radiance_.height() != height) {
    radiance_ = gl::Texture("composite/radiance", {.format = GL_RGBA32F, .width = width, .height = height});
    framebuffer_ = gl::Framebuffer("composite", {&radiance_});
  }
  std::vector<std::string> defines = bindSurfaces(in.surfaces);
  for (const std::string& variant : background_.variants(in.sky)) defines.push_back(variant);
  const gl::Program& program = context_.programs.get({.fragment = "composite.frag", .defines = std::move(defines)});
  program.use();
  background_.set(program, in.sky, in.surfaces);
  in.surfaces.albedo->bind(2);
  (in.emission ? in.surfaces.emission : &black_)->bind(3);
  (in.direct.irradiance ? in.direct.irradiance : &black_)->bind(4);
  (in.indirect.irradiance ? in.indirect.irradiance : &black_)->bind(5);
  (in.direct.glossy ? in.direct.glossy : &black_)->bind(8);
  (in.indirect.glossy ? in.indirect.glossy : &black_)->bind(9);
  framebuffer_.bind();
  gl::PipelineState{.width = width, .height = height}.apply();
  gl::drawFullscreen();
  return in.mixes && in.surfaces.blended ? mixBlended(*in.surfaces.blended) : radiance_;
}

const gl::Texture& CompositePass::mixBlended(const gl::Texture& blended) {
  const int width = radiance_.width(), height = radiance_.height();
  if (!mixed_ || mixed_.width() != width || mixed_.height() != height) {
    mixed_ = gl::Texture("composite/mixed", {.format = GL_RGBA32F, .width = width, .height = height});
    mixedFramebuffer_ = gl::Framebuffer("composite/mixed", {&mixed_});
  }
  context_.programs.get({.fragment = "blend.frag"}).use();
  radiance_.bind(2);
  blended.bind(3);
  mixedFramebuffer_.bind();
  gl::PipelineState{.width = width, .height = height}.apply();
  gl::drawFullscreen();
  return mixed_;
}

float ExposureMeter::measureNow(const gl::Texture& radiance) {
  std::vector<vec4> texels(size_t(radiance.width()) * size_t(radiance.height()));
  radiance.read(std::span(texels), GL_RGBA, GL_FLOAT);
  std::vector<vec3> surfaces;
  for (const vec4& texel : texels)
    if (texel.w > 0) surfaces.push_back(vec3(texel));
  const ExposureSums sums = sumForExposure(surfaces);
  dark_ = float(sums.dark());
  return sums.exposure();
}

void ExposureMeter::measure(const gl::Texture& radiance) {
  constexpr int kAcross = 64, kDown = 36;
  if (!sums_) {
    sums_ = gl::Texture("exposure", {.format = GL_RGBA32F, .width = kAcross, .height = kDown});
    framebuffer_ = gl::Framebuffer("exposure", {&sums_});
  }
  now_ = dark_ > 0 ? 0 : measureNow(radiance);
  const gl::PassScope scope = context_.scope(StageId::Display);
  const gl::Program& program = context_.programs.get({.fragment = "exposure.frag"});
  program.use();
  program.set("grid", glm::ivec2(kAcross, kDown));
  program.set("dark", dark_);
  radiance.bind(2);
  framebuffer_.bind();
  gl::PipelineState{.width = kAcross, .height = kDown}.apply();
  gl::drawFullscreen();
  unread_ = true;
}

float ExposureMeter::read() {
  if (!std::exchange(unread_, false)) return 0;
  std::vector<vec4> cells(size_t(sums_.width()) * size_t(sums_.height()));
  sums_.read(std::span(cells), GL_RGBA, GL_FLOAT);
  ExposureSums sums;
  for (const vec4& cell : cells) {
    sums.logs += double(cell.x), sums.weights += double(cell.y);
    sums.roots += double(cell.z), sums.count += double(cell.w);
  }
  dark_ = float(sums.dark());
  return now_ > 0 ? now_ : sums.exposure();
}

} // namespace lambent
