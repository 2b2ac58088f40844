#include "gi/contract/surface_lighting.h"

namespace lambent {

void LightTarget::fit(const GBuffer& surfaces, const glm::ivec2& size) {
  const bool glossy = surfaces.finish != nullptr;
  if (irradiance_ && this->size() == size && bool(glossy_) == glossy) return;
  const auto make = [&](const char* what) {
    return gl::Texture(label_ + "/" + what, {.format = GL_RGBA32F, .width = size.x, .height = size.y});
  };
  irradiance_ = make("irradiance");
  glossy_ = glossy ? make("glossy") : gl::Texture();
  framebuffer_ = glossy ? gl::Framebuffer(label_, {&irradiance_, &glossy_}) : gl::Framebuffer(label_, {&irradiance_});
}

void LightTarget::clear() const {
  framebuffer_.bind();
  gl::PipelineState{.width = size().x, .height = size().y}.apply(); // clearing keeps to the scissor
  const float black[4] = {};
  for (int i = 0; i < (glossy_ ? 2 : 1); ++i) glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, i, black);
}

} // namespace lambent
