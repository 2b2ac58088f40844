#include "gi/plan/presets.h"
#include "hard_case.h"

namespace lambent::test {

CameraView look(const vec3& eye, const vec3& target) {
  CameraView camera = lookAt(eye, target, 1.2f);
  camera.width = 32, camera.height = 18;
  return camera;
}

HardWorld::HardWorld(const char* preset) {
  scene.camera = look({0.1f, 0.1f, 0.9f}, {0, -0.1f, -1});
  settings.image.exposure = 1;
  if (preset) {
    applyPreset(settings, preset);
    return;
  }
  settings.smc = {.vpls = 64, .moves = 8, .points = 128, .warmup = 4};
  settings.shadow.resolution = 32;
  settings.shadow.maker = ShadowMaker::Rays;
  settings.vpl.mirCandidates = 4;
  settings.rsm.resolution = 32;
  settings.cube.resolution = 32;
}

void HardWorld::room(const vec3& lo, const vec3& hi, const vec3& albedo) {
  scene.box(lo, hi, scene.material(albedo), true);
}

LightView& HardWorld::lamp(const vec3& position, float intensity) {
  LightView& light = scene.lamp(position, vec3(intensity));
  light.id = uint32_t(scene.lights.size() - 1);
  light.changed = true;
  return light;
}

} // namespace lambent::test
