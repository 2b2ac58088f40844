// What the governor begins with, before any frame has told what frames cost.
#include "gi/plan/governor.h"

#include "tests/support/test.h"

namespace lambent::test::begin_test {

TEST(GovernorBegins, AsItIsWhereFramesAreFast) {
  const Governed g = begun({}, 20, 30);
  EXPECT_EQ(g.settings, Settings());
  EXPECT_EQ(g.scale, 1);
  EXPECT_TRUE(g.preset.empty());
}

TEST(GovernorBegins, WithACheaperPresetAndASmallerPictureWhereTheyAreSlow) {
  const Governed slow = begun({}, 3000, 100);
  EXPECT_EQ(slow.preset, presetTable().front().name);
  EXPECT_LT(slow.scale, 0.7f);
  EXPECT_GE(slow.scale, GovernorGains().least);
  EXPECT_FALSE(slow.choosesPreset) << "it is chosen";
  Governed kept;
  kept.choosesPreset = false;
  kept = begun(std::move(kept), 400, 100);
  EXPECT_EQ(kept.settings, Settings()) << "a person's own stay";
  EXPECT_NEAR(kept.scale, std::sqrt(0.95f * 0.25f), 1e-3f);
}

TEST(GovernorBegins, AndTheScaleThenFollowsTheLoad) {
  Governed g = begun({}, 1000, 50);
  const std::string preset = g.preset;
  const float before = g.scale;
  for (int i = 0; i < 60; ++i) g = governed(std::move(g), 200, 50); // slower than thought
  EXPECT_EQ(g.preset, preset);
  EXPECT_LT(g.scale, before);
}

} // namespace lambent::test::begin_test
