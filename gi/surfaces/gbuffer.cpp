// Depth, normal, albedo, emission, and on demand roughness and metalness of what the camera sees.
#include "gi/contract/passes.h"

#include <cmath>

namespace lambent {

namespace {

/// Far plane of an orthographic camera: behind everything in the scene, so that nothing is cut off.
float orthoFarFor(const CameraView& camera, const Aabb& scene) {
  const vec3 forward = -vec3(camera.worldFromView[2]);
  float farthest = camera.near + 1;
  for (int i = 0; i < 8 && !scene.empty(); ++i) {
    const vec3 corner(i & 1 ? scene.hi.x : scene.lo.x, i & 2 ? scene.hi.y : scene.lo.y,
                      i & 4 ? scene.hi.z : scene.lo.z);
    farthest = std::max(farthest, glm::dot(corner - camera.position(), forward));
  }
  return farthest * 1.01f;
}

} // namespace

CameraBlock cameraBlock(const CameraView& camera, float orthoFar) {
  const bool ortho = camera.orthoHalfHeight > 0;
  const float halfHeight = ortho ? camera.orthoHalfHeight : std::tan(0.5f * camera.fovY);
  return {
      .clipFromWorld = clipFromView(camera, orthoFar) * glm::inverse(camera.worldFromView),
      .worldFromView = camera.worldFromView,
      .lens = vec4(halfHeight * camera.aspect(), halfHeight, camera.near, ortho ? orthoFar : 0.0f),
      .size = vec4(camera.width, camera.height, 1.0f / float(camera.width), 1.0f / float(camera.height)),
  };
}

GBuffer GBufferPass::run(const GBufferInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Surfaces);
  const int width = in.camera.width, height = in.camera.height;
  if (depth_.width() != width || depth_.height() != height || !depth_ || in.glossy != bool(finish_)) {
    const auto make = [&](const char* label, GLenum format) {
      return gl::Texture(label, {.format = format, .width = width, .height = height});
    };
    depth_ = make("g-buffer/depth", GL_DEPTH_COMPONENT32F);
    normal_ = make("g-buffer/normal", GL_RGBA16F);
    albedo_ = make("g-buffer/albedo", GL_RGBA16F);
    emission_ = make("g-buffer/emission", GL_RGBA16F);
    finish_ = in.glossy ? make("g-buffer/finish", GL_RG16) : gl::Texture();
    framebuffer_ = in.glossy ? gl::Framebuffer("g-buffer", {&normal_, &albedo_, &emission_, &finish_}, &depth_)
                             : gl::Framebuffer("g-buffer", {&normal_, &albedo_, &emission_}, &depth_);
  }
  const CameraBlock block = cameraBlock(in.camera, orthoFarFor(in.camera, in.scene.bounds()));
  camera_ = cameras_.write(sizeof block, &block);
  camera_.bindUniform(0);

  framebuffer_.bind();
  gl::PipelineState{.depthTest = true, .depthWrite = true, .width = width, .height = height}.apply();
  const float zero[4] = {0, 0, 0, 0};
  for (int i = 0; i < (in.glossy ? 4 : 3); ++i) glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, i, zero);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, zero);
  in.scene.draw(in.glossy ? DrawKind::GlossyGBuffer : DrawKind::GBuffer, block.clipFromWorld, in.camera.position());
  return {&depth_, &normal_, &albedo_, &emission_, in.glossy ? &finish_ : nullptr, &camera_, block, width, height};
}

} // namespace lambent
