// The sky where no surface is seen.
#include "engine/gl/program.h"
#include "gi/viewer/viewer_stages.h"
#include "shaders/shared/sky.h"

namespace lambent {

std::vector<std::string> backgroundVariants(const Sky& sky) {
  return sky.constant() ? std::vector<std::string>{} : std::vector<std::string>{"DAYLIGHT"};
}

void setBackground(const gl::Program& program, const Sky& sky, const GBuffer& surfaces) {
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
