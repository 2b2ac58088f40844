// The scenes that one spot lights: what their shots promise, a knot that never meets itself, and plants that stay
// inside their house.
#include "engine/scene/shot.h"
#include "tests/content/placed.h"
#include "tests/content/written.h"

namespace lambent::test::spot_test {

const ContentRecipe& recipeOf(const std::string& name) {
  const auto& all = contentRecipes();
  return *std::ranges::find(all, name, &ContentRecipe::name);
}

class SpotScene : public testing::TestWithParam<const char*> {};

TEST_P(SpotScene, OneConeOf90DegreesMovesAndLightsSomeOfTheTrackedPixels) {
  SKIP_WHERE_TOO_LARGE(recipeOf(GetParam()));
  const Shot shot = loadShot(std::string(LAMBENT_SOURCE_DIR "/content/shots/") + GetParam() + ".json");
  Scene scene = loadScene(written(recipeOf(GetParam())).scene.file);
  const PlacedScene placed(scene);
  EXPECT_EQ(shot.pixels.size(), 8u);

  vec3 start(0);
  for (const double t : {0.0, 0.5 * shot.seconds, shot.seconds}) {
    SCOPED_TRACE("t = " + std::to_string(t));
    poseShot(scene, shot, t);
    SceneExtractor extractor;
    const SceneView view = extractor.extract(scene, {}, t);
    ASSERT_EQ(view.lights.size(), 1u);
    const LightView& light = view.lights[0];
    EXPECT_EQ(light.type, LightType::Spot);
    EXPECT_NEAR(light.outerConeCos, std::sqrt(0.5), 1e-5);
    EXPECT_FALSE(placed.inSolid(light.position));
    if (t == 0)
      start = light.position;
    else
      EXPECT_GT(glm::distance(light.position, start), 0.15f);

    // Both shapes of picture that the figures are made in.
    for (const glm::ivec2 size : {glm::ivec2(1024, 1024), glm::ivec2(480, 270)}) {
      CameraView camera = shotCamera(shot, t, scene.origin);
      camera.width = size.x;
      camera.height = size.y;
      int lit = 0;
      for (const vec2& pixel : shot.pixels) {
        const CameraRay ray = cameraRay(camera, pixel.x, pixel.y);
        const double distance = placed.distance(ray.origin, ray.direction);
        ASSERT_TRUE(std::isfinite(distance)) << "background at " << pixel.x << ", " << pixel.y;
        const dvec3 point = dvec3(ray.origin) + (distance - 1e-3) * dvec3(ray.direction);
        const dvec3 toPoint = point - dvec3(light.position);
        const bool inCone = glm::dot(glm::normalize(toPoint), dvec3(light.direction)) > light.outerConeCos;
        lit += inCone && placed.see(light.position, point);
      }
      EXPECT_GE(lit, 1) << size.x << "x" << size.y;
      EXPECT_LE(lit, 7) << size.x << "x" << size.y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shots, SpotScene,
                         testing::Values("cornell-spot", "knot", "knot-small", "garden", "garden-small"),
                         [](const auto& info) { return testName(info.param); });

TEST(Knot, NeverMeetsItself) {
  const PlacedScene placed(loadScene(written(recipeOf("knot-small")).scene.file));
  constexpr double kAside = 2e-3, kAbovePlinth = 0.58; // metres; the knot is sunk into its plinth
  int checked = 0;
  size_t number = 0;
  for (const PlacedTriangle& t : placed.triangles()) {
    if (placed.meshName(t) != "knot" || ++number % 41 != 0) continue;
    const dvec3 middle = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0;
    if (middle.y < kAbovePlinth) continue;
    ++checked;
    EXPECT_FALSE(placed.inSolid(middle + kAside * t.normal)) << middle.x << ", " << middle.y << ", " << middle.z;
    EXPECT_TRUE(placed.inSolid(middle - kAside * t.normal)) << middle.x << ", " << middle.y << ", " << middle.z;
  }
  EXPECT_GT(checked, 300);
}

TEST(Garden, PlantsStayInsideTheHouse) {
  constexpr double kHalfLength = 5.4, kHalfWidth = 3.3, kEaves = 2.7, kRidge = 4.1; // inside of the house, metres
  for (const char* name : {"garden", "garden-small"}) {
    SCOPED_TRACE(name);
    const PlacedScene placed(loadScene(written(recipeOf(name)).scene.file));
    int leaves = 0;
    for (const PlacedTriangle& t : placed.triangles()) {
      if (!t.sheet) continue;
      ++leaves;
      for (const dvec3& p : t.corner) {
        ASSERT_LT(std::abs(p.x), kHalfLength) << placed.meshName(t);
        ASSERT_LT(std::abs(p.z), kHalfWidth) << placed.meshName(t);
        ASSERT_LT(p.y, kRidge + (kEaves - kRidge) * std::abs(p.z) / kHalfWidth) << placed.meshName(t);
      }
    }
    EXPECT_GT(leaves, 5000);
  }
}

} // namespace lambent::test::spot_test
