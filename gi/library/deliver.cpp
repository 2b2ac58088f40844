#include "gi/library/deliver.h"

#include "engine/core/error.h"

namespace lambent {

namespace {

/// A framebuffer that draws into a texture; throws InputError where none can.
gl::Framebuffer into(uint32_t name) {
  gl::Framebuffer framebuffer("library/light");
  glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, name, 0);
  if (glCheckNamedFramebufferStatus(framebuffer.name(), GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw InputError("host's texture " + std::to_string(name) + " for light",
                     "has a format that cannot be drawn to (GL_RGBA16F, GL_R11F_G11F_B10F and GL_RGBA32F can)");
  return framebuffer;
}

} // namespace

void Delivery::check(int width, int height, const DeliveryTarget& to) {
  if (to.texture == 0) return;
  const gl::Texture theirs = gl::Texture::borrowed(to.texture);
  const std::string which = "host's texture " + std::to_string(to.texture) + " for light";
  if (theirs.width() == 0 || !theirs.readsAsFlat()) throw InputError(which, "is none (a GL_TEXTURE_2D with texels)");
  if (to.x < 0 || to.y < 0 || theirs.width() - to.x < width || theirs.height() - to.y < height)
    throw InputError(which, "has " + std::to_string(theirs.width()) + "x" + std::to_string(theirs.height()) +
                                " texels (" + std::to_string(width) + "x" + std::to_string(height) + " from " +
                                std::to_string(to.x) + "," + std::to_string(to.y) + " on are needed)");
  into(to.texture);
}

uint32_t Delivery::run(uint32_t light, int width, int height, const DeliveryTarget& to, int index) {
  if (to.texture == 0 && (!to.originTop || light == 0)) return light;
  gl::Texture& ours = ours_[index];
  if (to.texture == 0 && (!ours || ours.width() != width || ours.height() != height))
    ours = gl::Texture("library/light", {.format = GL_RGBA32F, .width = width, .height = height});
  const bool theirs = to.texture != 0;
  const uint32_t name = theirs ? to.texture : ours.name();
  const int x = theirs ? to.x : 0, y = theirs ? to.y : 0;
  const gl::Framebuffer framebuffer = into(name);
  framebuffer.bind();
  gl::PipelineState{.x = x, .y = y, .width = width, .height = height}.apply();
  const gl::Program& program = context_.programs.get({.fragment = "deliver.frag"});
  program.use();
  program.set("corner", glm::ivec2(x, y));
  program.set("height", height);
  program.set("originTop", int(to.originTop));
  program.set("lit", int(light != 0));
  gl::bindTexture(0, light);
  gl::bindSampler(0, 0);
  gl::drawFullscreen();
  return name;
}

} // namespace lambent
