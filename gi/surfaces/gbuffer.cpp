// Depth, normal, albedo, emission, and on demand the finish of what the camera sees.
#include "gi/surfaces/surfaces.h"

#include "engine/core/error.h"

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

/// CameraBlock::depthError of a host's depths, in the corners of the image, where a place is off by most.
vec4 depthErrorOf(const HostSurfaces& host, const CameraBlock& block) {
  const HostConventions& c = host.conventions;
  auto [absolute, relative] = gl::Texture::borrowed(host.depth).rounding();
  const bool ortho = block.lens.w > 0;
  const float corner = ortho ? 1 : glm::length(vec3(block.lens.x, block.lens.y, 1));
  if (c.depth == HostDepth::Linear) return corner * vec4(absolute, relative, 0, 0);
  constexpr float kSingle = 0x1p-24f; // of what is next to 1, as rasterisers compute it
  const float ofOne = relative + (c.depth == HostDepth::Forward ? kSingle : 0);
  const bool farIsZero = c.depth == HostDepth::Reversed && !c.depthMinusOne;
  if (c.depthMinusOne) absolute *= 0.5f;
  const float near = c.near > 0 ? c.near : block.lens.z;
  if (ortho) return {(absolute + ofOne) * ((c.near > 0 ? c.far : block.lens.w) - near), 0, 0, 0};
  return corner * (farIsZero ? vec4(0, relative, absolute / near, 0) : vec4(0, 0, (absolute + ofOne) / near, 0));
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
      .depthError = vec4(0),
  };
}

GBuffer SurfacePass::run(const SurfaceInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::Surfaces);
  const int width = in.camera.width, height = in.camera.height;
  CameraBlock block = cameraBlock(in.camera, orthoFarFor(in.camera, in.scene.bounds()));
  if (in.host) block.depthError = depthErrorOf(*in.host, block);
  camera_ = cameras_.write(sizeof block, &block);
  camera_.bindUniform(0);
  const bool theirs = in.host && in.host->conventions.ours(), converted = in.host && !theirs;
  if (!in.previous || theirs) before_ = {};
  if (theirs) {
    GBuffer adopted = adopt(in);
    adopted.block = block;
    return adopted;
  }
  const bool fits = depth_ && depth_.width() == width && depth_.height() == height;
  if (in.previous && in.keep) // the frame before showed the same
    before_ = {.depth = &depth_, .normal = &normal_, .block = block_, .width = width, .height = height};
  else if (in.previous)
    keepPrevious(fits);
  block_ = block;
  const bool glossy = in.glossy && !converted;
  const bool mapped = in.normalMaps && !converted;
  if (!fits || glossy != bool(finish_) || mapped != bool(mappedNormal_) || converted == bool(albedo_)) {
    const auto make = [&](const char* label, GLenum format, bool wanted = true) {
      return wanted ? gl::Texture(label, {.format = format, .width = width, .height = height}) : gl::Texture();
    };
    depth_ = make("g-buffer/depth", GL_DEPTH_COMPONENT32F);
    normal_ = make("g-buffer/normal", GL_RGBA16F);
    albedo_ = make("g-buffer/albedo", GL_RGBA16F, !converted);
    emission_ = make("g-buffer/emission", GL_RGBA16F);
    finish_ = make("g-buffer/finish", GL_RGBA16, glossy);
    mappedNormal_ = make("g-buffer/mapped normal", GL_RGBA16F, mapped);
    const gl::Texture *finish = glossy ? &finish_ : nullptr, *mappedNormal = mapped ? &mappedNormal_ : nullptr;
    framebuffer_ = converted
                       ? gl::Framebuffer("g-buffer", {&normal_, &emission_}, &depth_)
                       : gl::Framebuffer("g-buffer", {&normal_, &albedo_, &emission_, finish, mappedNormal}, &depth_);
  }
  const GBuffer out{&depth_,
                    &normal_,
                    converted ? nullptr : &albedo_,
                    &emission_,
                    glossy ? &finish_ : nullptr,
                    mapped ? &mappedNormal_ : nullptr,
                    converted || !in.scene.blends() ? nullptr : &blended_,
                    &camera_,
                    block,
                    width,
                    height};
  if (in.keep && !converted) return out;
  framebuffer_.bind();
  gl::PipelineState{.depthTest = true, .depthWrite = true, .width = width, .height = height}.apply();
  if (converted) {
    convert(*in.host);
    return out;
  }
  const float zero[4] = {0, 0, 0, 0};
  for (int i = 0; i < 5; ++i) glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, i, zero);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, zero);
  in.scene.drawSeen(gBufferWith(glossy, mapped), block.clipFromWorld, in.camera.position());
  if (out.blended) drawBlended(in);
  return out;
}

/// What blended surfaces let through of what is behind all of them, whichever a pixel shows.
void SurfacePass::drawBlended(const SurfaceInputs& in) {
  const int width = depth_.width(), height = depth_.height();
  if (!blended_ || blended_.width() != width || blended_.height() != height) {
    blended_ = gl::Texture("g-buffer/blended", {.format = GL_RG16, .width = width, .height = height});
    solidDepth_ =
        gl::Texture("g-buffer/solid depth", {.format = GL_DEPTH_COMPONENT32F, .width = width, .height = height});
    blendedFramebuffer_ = gl::Framebuffer("g-buffer/blended", {&blended_}, &solidDepth_);
  }
  blendedFramebuffer_.bind();
  const float zero = 0, one[4] = {1, 1, 1, 1};
  gl::PipelineState{.depthTest = true, .depthWrite = true, .colors = false, .width = width, .height = height}.apply();
  glClearNamedFramebufferfv(blendedFramebuffer_.name(), GL_DEPTH, 0, &zero);
  in.scene.drawSeen(DrawKind::SolidDepth, block_.clipFromWorld, in.camera.position());
  gl::PipelineState{.depthTest = true, .depthFunc = GL_GEQUAL, .multiply = true, .width = width, .height = height}
      .apply();
  glClearNamedFramebufferfv(blendedFramebuffer_.name(), GL_COLOR, 0, one);
  in.scene.drawSeen(DrawKind::Blended, block_.clipFromWorld, in.camera.position());
}

void SurfacePass::keepPrevious(bool any) {
  before_ = {};
  if (!any) return;
  const int width = depth_.width(), height = depth_.height();
  if (!depthBefore_ || depthBefore_.width() != width || depthBefore_.height() != height) {
    depthBefore_ =
        gl::Texture("g-buffer/depth before", {.format = GL_DEPTH_COMPONENT32F, .width = width, .height = height});
    normalBefore_ = gl::Texture("g-buffer/normal before", {.format = GL_RGBA16F, .width = width, .height = height});
  }
  for (const auto& [from, to] : {std::pair(&depth_, &depthBefore_), std::pair(&normal_, &normalBefore_)})
    glCopyImageSubData(from->name(), GL_TEXTURE_2D, 0, 0, 0, 0, to->name(), GL_TEXTURE_2D, 0, 0, 0, 0, width, height,
                       1);
  before_ = {.depth = &depthBefore_, .normal = &normalBefore_, .block = block_, .width = width, .height = height};
}

/// Draws the host's surfaces into the framebuffer that is bound, as ours.
void SurfacePass::convert(const HostSurfaces& host) {
  if (!plain_) {
    plain_ = gl::Sampler("g-buffer/host");
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glSamplerParameteri(plain_.name(), filter, GL_NEAREST);
  }
  const HostConventions& c = host.conventions;
  gl::PipelineState{
      .depthTest = true, .depthWrite = true, .depthFunc = GL_ALWAYS, .width = depth_.width(), .height = depth_.height()}
      .apply();
  const gl::Program& program = context_.programs.get({.fragment = "adopt.frag"});
  program.use();
  program.set("corner", glm::ivec2(c.x, c.y));
  program.set("originTop", int(c.originTop));
  program.set("depthType", int(c.depth));
  program.set("depthMinusOne", int(c.depthMinusOne));
  program.set("hostNear", c.near);
  program.set("nearOverFar", c.near / c.far);
  program.set("hostFar", c.far);
  program.set("normalType", int(c.normals));
  program.set("viewSpace", int(c.viewSpace));
  program.set("emits", int(host.emission != 0));
  gl::bindTexture(0, host.depth);
  gl::bindTexture(1, host.normal);
  gl::bindTexture(2, host.emission != 0 ? host.emission : host.normal);
  for (int unit = 0; unit < 3; ++unit) gl::bindSampler(unit, plain_.name());
  gl::drawFullscreen();
  for (int unit = 0; unit < 3; ++unit) gl::bindSampler(unit, 0);
}

void checkHost(const HostSurfaces& host, const CameraView& camera) {
  const HostConventions& c = host.conventions;
  if (c.x < 0 || c.y < 0) throw InputError("host's rectangle", "begins outside of its textures");
  if (c.depth == HostDepth::Forward && !(c.near > 0))
    throw InputError("host's planes", "near is not given, which forward depth needs");
  if (c.depth != HostDepth::Linear && c.near > 0 && !(c.far > c.near))
    throw InputError("host's planes", "far is not beyond near");
  const auto check = [&](const char* what, uint32_t name, bool needed) {
    const std::string which = std::string("host's ") + what + " texture " + std::to_string(name);
    if (name == 0 && !needed) return;
    const gl::Texture texture = gl::Texture::borrowed(name);
    if (texture.width() != 0 && !texture.readsAsFlat()) throw InputError(which, "is not a GL_TEXTURE_2D of floats");
    if (texture.width() != 0 && texture.readsOtherThanLevel0())
      throw InputError(which, "is read from another level than 0, or as stencil (GL_TEXTURE_BASE_LEVEL 0, "
                              "GL_DEPTH_STENCIL_TEXTURE_MODE GL_DEPTH_COMPONENT)");
    if (texture.width() != 0 && c.ours() && texture.comparesDepths())
      throw InputError(which, "compares depths (GL_TEXTURE_COMPARE_MODE GL_NONE)");
    const bool holds = c.ours() ? texture.width() == camera.width && texture.height() == camera.height
                                : texture.width() - c.x >= camera.width && texture.height() - c.y >= camera.height;
    if (holds && name != 0) return;
    throw InputError(which,
                     "has " + std::to_string(texture.width()) + "x" + std::to_string(texture.height()) + " texels (" +
                         std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                         (c.ours() ? ", as the camera)"
                                   : " from " + std::to_string(c.x) + "," + std::to_string(c.y) + " on are needed)"));
  };
  check("depth", host.depth, true);
  check("normal", host.normal, true);
  check("albedo", host.albedo, false);
  check("emission", host.emission, false);
  check("finish", host.finish, false);
}

GBuffer SurfacePass::adopt(const SurfaceInputs& in) {
  const int width = in.camera.width, height = in.camera.height;
  const auto take = [&](gl::Texture& ours, uint32_t name) -> const gl::Texture* {
    ours = name != 0 ? gl::Texture::borrowed(name) : gl::Texture();
    return name != 0 ? &ours : nullptr;
  };
  const HostSurfaces& host = *in.host;
  GBuffer out{take(hosts_[0], host.depth),
              take(hosts_[1], host.normal),
              take(hosts_[2], host.albedo),
              take(hosts_[3], host.emission),
              in.glossy ? take(hosts_[4], host.finish) : nullptr,
              nullptr, // what hosts draw is one normal
              nullptr,
              &camera_,
              {},
              width,
              height};
  if (!out.emission) {
    if (!black_ || black_.width() != width || black_.height() != height) {
      black_ = gl::Texture("g-buffer/no emission", {.format = GL_RGBA16F, .width = width, .height = height});
      black_.clear();
    }
    out.emission = &black_;
  }
  return out;
}

} // namespace lambent
