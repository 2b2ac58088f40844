// Rays that check shadow maps: averaged, they come to what a ray for every pair gives, and only where a view stands.
#include "still_room.h"

namespace lambent::test::map_checks_test {

class MapChecksTest : public StillRoomTest, public ::testing::WithParamInterface<int> {
 protected:
  MapChecksTest() {
    settings.shadow.resolution = 16; // in whose texels the block's shadow is coarse
    room.scene.lights[0].intensity = {1, 0.8f, 0.5f};
    room.scene.size(81, 54); // no whole number of blocks
  }

  /// Irradiance after 64 pictures of a still view.
  Image averaged(bool checks) const {
    Settings s = settings;
    s.gather.checks = checks;
    Viewer gi(s);
    stand(gi, 64);
    return gi.read(Buffer::Irradiance);
  }
};

INSTANTIATE_TEST_SUITE_P(Lights, MapChecksTest,
                         ::testing::Values(512, 3000)); // in one array of maps; in two, one of them not full

TEST_P(MapChecksTest, ComeToARayForEveryPair) {
  settings.smc.vpls = GetParam();
  settings.gather.glossy = GetParam() == 512; // another place among the gather's targets
  Settings byRays = settings;
  byRays.vpl.visibility = VplVisibility::Rays;
  const Image expected = firstFrame(byRays, room.scene.view()), checked = averaged(true), believed = averaged(false);
  EXPECT_LT(relativeRmse(checked, expected), 0.45 * relativeRmse(believed, expected));
  EXPECT_NEAR(meanLuminance(checked), meanLuminance(expected), 0.0015 * meanLuminance(expected));
  EXPECT_GT(std::abs(meanLuminance(believed) - meanLuminance(expected)), 0.006 * meanLuminance(expected))
      << "there is something to mend";
}

TEST_F(MapChecksTest, OnlyWhileTheViewStands) {
  Viewer gi(settings);
  EXPECT_EQ(gi.run(room.scene.view()).raysChecks.occlusion, 0u);
  const uint64_t rays = gi.run(still()).raysChecks.occlusion;
  EXPECT_GT(rays, 3500u);
  EXPECT_LE(rays, 81u * 54u);
  EXPECT_EQ(gi.run(view(kCameraChanged)).raysChecks.occlusion, 0u) << "camera";
  EXPECT_EQ(gi.run(view(kLightsChanged)).raysChecks.occlusion, 0u) << "light";
  int frames = 0; // means still follow it, then the view comes to rest
  while (frames < 100 && gi.run(still()).raysChecks.occlusion < 3500u) ++frames;
  EXPECT_EQ(frames, 27);
  gi.settings().gather.checks = false;
  EXPECT_EQ(gi.run(still()).raysChecks.occlusion, 0u);
}

} // namespace lambent::test::map_checks_test
