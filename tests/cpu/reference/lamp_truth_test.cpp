// Brute force to lamps, against the closed form of what they bring where nothing is between, and none where all is.
#include "gi/lighting/area_lights.h"
#include "gi/measure/lamp_truth.h"
#include "tests/support/hand_scene.h"
#include "tests/support/test.h"

namespace lambent::test::lamp_truth_test {

struct Rectangle { // of what lies flat: x and z
  vec2 lo, hi;
};

/// Two lamps of unlike brightness above a floor, one of them in two halves and facing both ways, and a plate half way
/// up. From a point of the floor all are rectangles: open, hidden or partly so.
TEST(LampTruthTest, IsTheClosedFormOfWhatIsOpen) {
  constexpr float kHeight = 2, kPlate = 1;
  const Rectangle lamps[] = {{{-1.2f, -0.3f}, {-0.4f, 0.3f}}, {{0.6f, -0.2f}, {0.8f, 0.2f}}},
                  plate = {{-0.5f, -0.5f}, {0.3f, 0.3f}};
  HandScene scene;
  scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), scene.material(vec3(0.5f)));
  const uint32_t dim = scene.material(vec3(0), vec3(5, 4, 3)), bright = scene.material(vec3(0), vec3(30, 60, 90));
  for (const int half : {0, 1})
    scene.quad(vec3(-1.2f + 0.4f * float(half), kHeight, -0.3f), vec3(0.4f, 0, 0), vec3(0, 0, 0.6f), dim);
  scene.quad(vec3(0.6f, kHeight, -0.2f), vec3(0.2f, 0, 0), vec3(0, 0, 0.4f), bright);
  scene.quad(vec3(-0.5f, kPlate, -0.5f), vec3(0.8f, 0, 0), vec3(0, 0, 0.8f), scene.material(vec3(0.5f)));
  scene.camera = cameraAt(vec3(0, 1.8f, 3), vec3(0, 0.2f, 0), 1.0f, 48, 32);
  const SceneView view = scene.view();
  const LampTruth truth = traceLamps(view, 1024);
  const AreaLights lights = areaLights(collectLights(view));
  int seen[2][2] = {}; // pixels by which of the lamps are open
  double squares = 0, noise = 0;
  for (const auto [x, y] : Pixels(48, 32)) {
    const CameraRay ray = pixelRay(scene.camera, x, y);
    const vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
    if (ray.direction.y >= 0 || std::abs(at.x) > 9 || at.z < -9 || truth.distance.at(x, y).x == 0) continue;
    const float floor = glm::dot(at - scene.camera.position(), -vec3(scene.camera.worldFromView[2]));
    if (std::abs(truth.distance.at(x, y).x - floor) > 0.01f) continue; // the plate
    vec3 expected(0);
    int open[2] = {};
    bool partly = false;
    for (const int l : {0, 1}) {
      const vec2 here(at.x, at.z);
      const vec2 lo = glm::mix(here, lamps[l].lo, kPlate / kHeight), hi = glm::mix(here, lamps[l].hi, kPlate / kHeight);
      const vec2 both = glm::min(hi, plate.hi) - glm::max(lo, plate.lo);
      const bool beside = both.x < 0 || both.y < 0, hidden = both == hi - lo;
      partly |= !beside && !hidden;
      open[l] = beside;
      if (!beside) continue;
      for (const AreaLight& light : lights.lights)
        if ((lights.samples[light.firstSample].position.x > 0) == (l == 1))
          expected += unshadowed(lights, light, at, vec3(0, 1, 0)) * 0.5f / kPi;
    }
    if (partly) continue;
    ++seen[open[0]][open[1]];
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(truth.light.at(x, y)[c], expected[c], 5e-3f * expected[c]) << x << ' ' << y;
    const float off = truth.light.at(x, y).x - expected.x, own = truth.noise.at(x, y).x;
    squares += double(off * off);
    noise += double(own * own);
  }
  EXPECT_GT(seen[1][1], 300);
  EXPECT_GT(seen[0][1], 5) << "in the shadow of the wide lamp";
  EXPECT_GT(seen[1][0], 5) << "in that of the bright one";
  EXPECT_LT(squares, 4 * noise) << "it knows its own noise";
  EXPECT_LT(noise, 16 * squares);
}

} // namespace lambent::test::lamp_truth_test
