// What direct and reflected light agree on about a punctual light.
#include "gi/contract/light_views.h"

#include "tests/support/test.h"

namespace lambent::test::light_views_test {

LightView lightOf(LightType type, float outerDegrees = 45) {
  LightView light;
  light.type = type;
  light.outerConeCos = std::cos(glm::radians(outerDegrees));
  light.innerConeCos = std::cos(glm::radians(0.5f * outerDegrees));
  return light;
}

TEST(LightViews, WideSpotsTakeACube) {
  EXPECT_EQ(kindOf(lightOf(LightType::Point)), LightKind::Cube);
  EXPECT_EQ(kindOf(lightOf(LightType::Directional)), LightKind::Sun);
  EXPECT_EQ(kindOf(lightOf(LightType::Spot, 69)), LightKind::Spot);
  EXPECT_EQ(kindOf(lightOf(LightType::Spot, 71)), LightKind::Cube);
}

TEST(LightViews, DarkAndBrokenLightsDoNotShine) {
  LightView light;
  light.intensity = vec3(0, 0, 1);
  EXPECT_TRUE(shines(light));
  for (const vec3& none : {vec3(0), vec3(-1), vec3(1, std::numeric_limits<float>::quiet_NaN(), 1),
                           vec3(std::numeric_limits<float>::infinity(), 1, 1)}) {
    light.intensity = none;
    EXPECT_FALSE(shines(light));
  }
}

TEST(LightViews, ConesFallOffFromTheInnerToTheOuterAngle) {
  const LightView spot = lightOf(LightType::Spot, 40);
  const vec2 cone = coneFactors(spot);
  EXPECT_NEAR(cone.x * spot.innerConeCos + cone.y, 1, 1e-5f);
  EXPECT_NEAR(cone.x * spot.outerConeCos + cone.y, 0, 1e-5f);
  EXPECT_EQ(coneFactors(lightOf(LightType::Point)), vec2(0, 1));
  LightView sharp = spot;
  sharp.innerConeCos = sharp.outerConeCos;
  EXPECT_NEAR(coneFactors(sharp).x, 1000, 1e-2f);
}

TEST(LightViews, RangeAndNearPlane) {
  LightView light;
  EXPECT_EQ(inverseRange4(light), 0);
  light.range = 2;
  EXPECT_EQ(inverseRange4(light), 1.0f / 16);
  light.range = 0;
  EXPECT_EQ(inverseRange4(light), 0);
  Aabb bounds;
  bounds.add(vec3(0));
  EXPECT_GT(nearPlane(bounds), 0);
  bounds.add(vec3(0, 30, 40));
  EXPECT_NEAR(nearPlane(bounds), 0.005f, 1e-7f);
}

} // namespace lambent::test::light_views_test
