#include "engine/trace/embree_query.h"
#include "engine/trace/open_sky.h"
#include "tests/support/comparator_world.h"
#include "tests/support/hand_scene.h"

namespace lambent::test::open_sky_test {

bool reaches(const HandScene& scene, const vec3& eye) {
  EmbreeQuery rays(scene.assets);
  rays.update(scene.view());
  return skyReaches(rays, eye);
}

TEST(OpenSky, ReachesNothingInARoomAndWhoStandsOutside) {
  HandScene scene;
  scene.box({-2, 0, -3}, {2, 2.5f, 3}, scene.material(vec3(0.5f)), true);
  EXPECT_FALSE(reaches(scene, {0, 1.6f, 0}));
  EXPECT_FALSE(reaches(scene, {1.9f, 0.1f, -2.9f}));
  EXPECT_TRUE(reaches(scene, {5, 1.6f, 0}));
}

TEST(OpenSky, IsAbove) {
  HandScene scene;
  scene.box({-2, 0, -3}, {2, 2.5f, 3}, scene.material(vec3(0.5f)), true);
  scene.instances.erase(scene.instances.begin() + 2); // the floor
  EXPECT_FALSE(reaches(scene, {0, 1.6f, 0}));
}

TEST(OpenSky, ReachesARoomWithAWindowAndNotThatBehindAKeyhole) {
  for (const float side : {1.0f, 0.3f}) {
    HandScene scene;
    const uint32_t wall = scene.material(vec3(0.5f));
    scene.box({-2, 0, -3}, {2, 2.5f, 3}, wall, true);
    scene.instances.pop_back(); // the wall at z = 3 gets a hole in its middle
    const float left = -0.5f * side, low = 1.2f;
    scene.quad({-2, 0, 3}, {0, 2.5f, 0}, {2 + left, 0, 0}, wall);
    scene.quad({left + side, 0, 3}, {0, 2.5f, 0}, {2 - left - side, 0, 0}, wall);
    scene.quad({left, 0, 3}, {0, low, 0}, {side, 0, 0}, wall);
    scene.quad({left, low + side, 3}, {0, 2.5f - low - side, 0}, {side, 0, 0}, wall);
    EXPECT_EQ(reaches(scene, {0, 1.6f, 2}), side == 1.0f);
  }
}

TEST(OpenSky, ReachesUnderABalconyByTheFloorBeforeIt) {
  // A court with high walls; the eye is in a niche with a roof, and no straight line from it leads upwards and out.
  HandScene scene;
  const uint32_t wall = scene.material(vec3(0.5f));
  scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, wall);
  scene.quad({-4, 0, -4}, {0, 12, 0}, {8, 0, 0}, wall);
  scene.quad({-4, 0, 4}, {0, 12, 0}, {8, 0, 0}, wall);
  scene.quad({-4, 0, -4}, {0, 12, 0}, {0, 0, 8}, wall);
  scene.quad({4, 0, -4}, {0, 12, 0}, {0, 0, 8}, wall);
  scene.quad({-4, 2, -4}, {0, 0, 8}, {3, 0, 0}, wall);
  EXPECT_TRUE(reaches(scene, {-3.5f, 0.3f, 0}));
}

/// Half of the picture is a sheet that is seen from behind, before a floor; the sky is not looked through.
TEST(OpenSky, TellsWhatTheEyeLooksThrough) {
  HandScene scene;
  const uint32_t hidden = scene.material(vec3(0.5f));
  scene.assets.materials[hidden].backHidden = true;
  scene.quad({-9, -9, -4}, {18, 0, 0}, {0, 18, 0}, scene.material(vec3(0.5f)));
  const auto share = [&] { return shareLookedThrough(TracedScene(scene).rays, cameraAlong(vec3(0), {0, 0, -1})); };
  EXPECT_EQ(share(), 0);
  scene.quad({0, -9, -2}, {0, 18, 0}, {9, 0, 0}, hidden);
  EXPECT_EQ(share(), 0.5f);
  scene.assets.materials[hidden].backHidden = false;
  EXPECT_EQ(share(), 0);
  EXPECT_EQ(shareLookedThrough(TracedScene(scene).rays, cameraAlong(vec3(0), {0, 0, 1})), 0);
}

} // namespace lambent::test::open_sky_test
