#include "game/rules/day.h"

#include "tests/support/test.h"

namespace lambent::test::day_test {

TEST(Day, TheSunRisesInTheEastStandsHighAtNoonAndIsGoneAtNight) {
  EXPECT_NEAR(towardsSun(6).x, 1, 1e-5f);
  EXPECT_NEAR(towardsSun(6).y, 0, 1e-5f);
  EXPECT_NEAR(towardsSun(12).y, 0.866f, 1e-3f);
  EXPECT_GT(towardsSun(12).z, 0.49f);
  EXPECT_NEAR(towardsSun(18).x, -1, 1e-5f);
  EXPECT_LT(towardsSun(0).y, -0.8f);
  for (double hour = 0; hour < 24; hour += 0.5) EXPECT_NEAR(glm::length(towardsSun(hour)), 1, 1e-5f);
}

TEST(Day, TakesThePlaceOfTheScenesLightAndGivesItBack) {
  Scene scene;
  scene.sky = Sky(vec3(0.3f));
  LightView own;
  own.type = LightType::Directional;
  own.intensity = {1, 2, 3};
  const Entity sun = addLight(scene, own, "sun");
  own.type = LightType::Point;
  addLight(scene, own, "lamp");
  const auto lights = [&] {
    SceneExtractor extractor;
    const SceneView view = extractor.extract(scene, {}, 0);
    return std::vector<LightView>(view.lights.begin(), view.lights.end());
  };
  const std::vector<LightView> before = lights();

  Day day(scene);
  day.apply();
  EXPECT_EQ(lights().size(), 2u) << "nothing until an hour is set";
  day.set(12);
  day.apply();
  const std::vector<LightView> noon = lights();
  ASSERT_EQ(noon.size(), 3u);
  EXPECT_EQ(noon[0].intensity, vec3(0)) << "the scene's own sun";
  EXPECT_EQ(noon[1].intensity, vec3(1, 2, 3)) << "lamps stay";
  EXPECT_LT(glm::distance(noon[2].direction, -towardsSun(12)), 1e-4f);
  EXPECT_GT(noon[2].intensity.y, 1);
  EXPECT_FALSE(scene.sky.constant());

  scene.registry.get<PunctualLight>(sun).intensity = {9, 9, 9}; // as a shot does in every frame
  day.set(23);
  day.apply();
  EXPECT_EQ(lights()[0].intensity, vec3(0));
  EXPECT_EQ(lights()[2].intensity, vec3(0)) << "night";
  EXPECT_LT(luminance(scene.sky.radiance({0, 1, 0})), 0.01f);

  day.set({});
  day.apply();
  const std::vector<LightView> after = lights();
  ASSERT_EQ(after.size(), 2u);
  EXPECT_EQ(after[0].intensity, before[0].intensity);
  EXPECT_TRUE(scene.sky == Sky(vec3(0.3f)));
}

} // namespace lambent::test::day_test
