// The sky where no surface is seen.
#include "engine/gl/program.h"
#include "gi/viewer/viewer_stages.h"
#include "shaders/shared/sky.h"

namespace lambent {

std::vector<std::string> Background::variants(const Sky& sky) const {
  if (sky.constant()) return {};
  return sky.picture().image ? std::vector<std::string>{"DAYLIGHT", "SKY_IMAGE"} : std::vector<std::string>{"DAYLIGHT"};
}

void Background::set(const gl::Program& program, const Sky& sky, const GBuffer& surfaces) {
  if (const Sky::Picture& picture = sky.picture(); picture.image) {
    if (shown_ != picture.image) {
      const SkyImage& image = *picture.image;
      texture_ = gl::Texture("sky", {.format = GL_RGBA16F, .width = image.width, .height = image.height});
      glTextureSubImage2D(texture_.name(), 0, 0, 0, image.width, image.height, GL_RGB, GL_FLOAT, image.texels.data());
      shown_ = picture.image;
    }
    surfaces.camera->bindUniform(0);
    texture_.bind(11);
    program.set("skyScaleTurn", vec2(picture.scale, picture.turn));
    return;
  }
  shown_ = nullptr;
  texture_ = {};
  const DaylightModel* model = sky.model();
  if (!model) {
    program.set("skyRadiance", sky.radiance({0, 1, 0}));
    return;
  }
  surfaces.camera->bindUniform(0);
  program.set("daylight.towardsSun", model->towardsSun);
  program.set("daylight.zenith", model->zenith);
  program.set("daylight.a", model->a);
  program.set("daylight.b", model->b);
  program.set("daylight.c", model->c);
  program.set("daylight.d", model->d);
  program.set("daylight.e", model->e);
  program.set("daylight.ground", model->ground);
}

} // namespace lambent
