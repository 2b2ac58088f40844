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
  settings.smc.vpls = 64;
  settings.smc.points = 128;
  settings.smc.warmup = 4;
  settings.smc.moves = 8;
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
  LightView light;
  light.id = uint32_t(scene.lights.size());
  light.position = position;
  light.intensity = vec3(intensity);
  light.changed = true;
  scene.lights.push_back(light);
  return scene.lights.back();
}

void HardWorld::place(uint32_t index, const mat4& worldFromObject) {
  InstanceView& i = scene.instances[index];
  i.worldFromObjectBefore = i.worldFromObject;
  i.boundsWorldBefore = i.boundsWorld;
  i.worldFromObject = worldFromObject;
  i.boundsWorld = transformed(scene.assets.meshes[i.mesh].boundsObject, worldFromObject);
  i.moved = true;
}

} // namespace lambent::test
