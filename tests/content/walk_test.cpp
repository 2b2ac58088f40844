// Camera walks through the scenes that are made on demand: the eye is where a head can be and never passes a wall, and
// no lamp is walled in.
#include "engine/scene/shot.h"
#include "tests/content/placed.h"
#include "tests/content/written.h"

namespace lambent::test::walk_test {

struct Walk {
  std::string name; // of the shot
  ContentRecipe recipe;
};

std::vector<Walk> walks() {
  std::vector<Walk> found;
  for (const auto& entry : std::filesystem::directory_iterator(LAMBENT_SOURCE_DIR "/content/shots")) {
    const std::string scene = loadShot(entry.path()).scene.stem().string();
    for (const ContentRecipe& r : contentRecipes())
      if (r.name == scene && !r.bundled) found.push_back({entry.path().stem().string(), r});
  }
  std::ranges::sort(found, {}, &Walk::name);
  return found;
}

void PrintTo(const Walk& walk, std::ostream* out) { *out << walk.name; }

class Walks : public testing::TestWithParam<Walk> {};

TEST_P(Walks, KeepClearOfWalls) {
  const auto& [name, recipe] = GetParam();
  SKIP_WHERE_TOO_LARGE(recipe);
  const Shot shot = loadShot(std::string(LAMBENT_SOURCE_DIR "/content/shots/") + name + ".json");
  EXPECT_EQ(shot.pixels.size(), 8u);

  Scene scene = loadScene(written(recipe).scene.file);
  const PlacedScene placed(scene);
  constexpr double kStep = 0.25, kClearance = 0.25; // seconds, metres
  dvec3 before(0);
  for (int i = 0; i * kStep <= shot.seconds; ++i) {
    const double t = i * kStep;
    SCOPED_TRACE("t = " + std::to_string(t));
    EXPECT_NO_THROW(poseShot(scene, shot, t)); // names a light that the scene lacks?
    SceneExtractor extractor;
    for (const LightView& light : extractor.extract(scene, {}, t).lights) {
      if (light.type == LightType::Directional) continue;
      EXPECT_FALSE(placed.inSolid(light.position));
    }
    const dvec3 eye = shotCamera(shot, t, scene.origin).position();
    ASSERT_FALSE(placed.inSolid(eye));
    const double height = placed.distance(eye, dvec3(0, -1, 0));
    EXPECT_GT(height, 1.4);
    EXPECT_LT(height, 2.1);
    for (int k = 0; k < 8; ++k) {
      const double angle = 0.785398 * (k + 0.1);
      EXPECT_TRUE(placed.see(eye, eye + kClearance * dvec3(std::cos(angle), 0, std::sin(angle)))) << "direction " << k;
    }
    if (i > 0) {
      EXPECT_TRUE(placed.see(before, eye)) << "a wall between this place and the last";
      EXPECT_LT(glm::distance(before, eye), 2.2 * kStep) << "too fast for a walk";
    }
    before = eye;
  }
}

INSTANTIATE_TEST_SUITE_P(Shots, Walks, testing::ValuesIn(walks()),
                         [](const auto& info) { return testName(info.param.name); });

} // namespace lambent::test::walk_test
