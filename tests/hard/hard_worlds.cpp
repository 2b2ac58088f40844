#include "tests/hard/hard_worlds.h"

#include "gi/plan/presets.h"

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

void roomOf(HardWorld& w, float unit, const vec3& centre, float light) {
  w.room(centre - vec3(unit), centre + vec3(unit));
  w.lamp(centre + unit * vec3(0.1f, 0.3f, 0.2f), light * unit * unit);
  w.scene.camera = look(centre + unit * vec3(0.1f, 0.1f, 0.9f), centre - unit * vec3(0, 0.1f, 1));
  w.scene.camera.near = 0.01f * unit;
}

void fineMaps(HardWorld& w) { w.settings.shadow.resolution = 128; }

void twoRooms(HardWorld& w, float wall) {
  fineMaps(w);
  w.room(vec3(-1), vec3(1));
  w.room(vec3(1 + wall, -1, -1), vec3(3 + wall, 1, 1));
  w.lamp({2 + wall, 0.3f, 0});
  w.scene.camera = look({-0.9f, 0, 0}, {1, 0, 0});
}

void doorway(HardWorld& w) {
  fineMaps(w);
  w.room(vec3(-1), {3.1f, 1, 1});
  const uint32_t white = w.scene.assets.meshes[0].primitives[0].material;
  w.scene.box({1.02f, -1.1f, -0.45f}, {1.08f, 0.65f, 0.45f}, white, false); // 6 to 11
  w.scene.box({1, -1.1f, -1.1f}, {1.1f, 1.1f, -0.4f}, white, false);
  w.scene.box({1, -1.1f, 0.4f}, {1.1f, 1.1f, 1.1f}, white, false);
  w.scene.box({1, 0.6f, -0.5f}, {1.1f, 1.1f, 0.5f}, white, false);
  w.lamp({2.1f, 0.3f, 0}, 10);
  w.scene.camera = look({-0.9f, 0, 0}, {1, 0, 0});
}

void slide(HardWorld& w, float open) {
  for (uint32_t i = 6; i < 12; ++i) w.scene.place(i, glm::translate(mat4(1), vec3(0, 0, -0.05f - open)));
}

void lamps(HardWorld& w, int count) {
  for (int i = 0; i < count; ++i)
    w.lamp(0.9f * vec3(std::sin(float(i) * 12.99f), std::sin(float(i) * 78.23f), std::sin(float(i) * 37.72f)),
           1.0f / float(count));
}

void spot(LightView& light, const vec3& direction, float cosine) {
  light.type = LightType::Spot;
  light.direction = glm::normalize(direction);
  light.innerConeCos = light.outerConeCos = cosine;
}

} // namespace lambent::test
