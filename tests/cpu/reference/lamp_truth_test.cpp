// Brute force to lamps, against the closed form of what they bring where nothing is between, and in their shadow.
#include "gi/lighting/area_lights.h"
#include "gi/measure/lamp_truth.h"
#include "tests/support/hand_scene.h"
#include "tests/support/test.h"

namespace lambent::test::lamp_truth_test {

TEST(LampTruthTest, IsTheClosedFormUnderAnOpenLampAndBlackInFullShadow) {
  HandScene scene;
  scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), scene.material(vec3(0.5f)));
  scene.quad(vec3(-0.4f, 2, -0.3f), vec3(0.8f, 0, 0), vec3(0, 0, 0.6f), scene.material(vec3(0), vec3(5, 4, 3)));
  scene.quad(vec3(0.7f, 1, -0.2f), vec3(0.8f, 0, 0), vec3(0, 0, -0.8f), scene.material(vec3(0.5f))); // a plate
  scene.camera = cameraAt(vec3(0, 1.8f, 3), vec3(0, 0.2f, 0), 1.0f, 48, 32);
  const SceneView view = scene.view();
  const LampTruth truth = traceLamps(view, 1024);
  const AreaLights lights = areaLights(collectLights(view));
  int open = 0, dark = 0;
  for (const auto [x, y] : Pixels(48, 32)) {
    const CameraRay ray = pixelRay(scene.camera, x, y);
    const vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
    if (ray.direction.y >= 0 || std::abs(at.x) > 9 || at.z < -9 || truth.distance.at(x, y).x == 0) continue;
    const float floor = glm::dot(at - scene.camera.position(), -vec3(scene.camera.worldFromView[2]));
    if (std::abs(truth.distance.at(x, y).x - floor) > 0.01f) continue; // the plate
    const vec3 expected = unshadowed(lights, lights.lights[0], at, vec3(0, 1, 0)) * 0.5f / kPi;
    if (truth.light.at(x, y).x == 0) {
      ++dark;
      continue;
    }
    if (at.x > 0.3f) continue; // may be in half shadow
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(truth.light.at(x, y)[c] / expected[c], 1, 5e-3) << x << ' ' << y;
    ++open;
  }
  EXPECT_GT(open, 300);
  EXPECT_GT(dark, 0);
}

} // namespace lambent::test::lamp_truth_test
