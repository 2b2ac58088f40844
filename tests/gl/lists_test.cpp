// Lights by lists against every light at every pixel, and where lists serve.
#include "still_room.h"

namespace lambent::test::lists_test {

class ListsTest : public AveragedRoomTest {};

TEST_F(ListsTest, ListsOfFewLightsAreEveryLight) {
  settings.smc.vpls = settings.gather.lights = 512;
  settings.filter.on = false;
  settings.gather.near = 0;
  for (const bool maps : {false, true}) {
    settings.vpl.visibility = maps ? VplVisibility::Maps : VplVisibility::None;
    const Image all = allLights(), lists = firstFrame(with(settings, GatherMode::Lists, 0), room.scene.view());
    EXPECT_LT(relativeRmse(lists, all), 1e-5) << maps;
  }
}

TEST_F(ListsTest, ListsHaveLessNoiseThanSubsets) {
  settings.filter.on = false;
  settings.gather.near = 0;
  const Image all = allLights();
  double errors[2];
  for (const GatherMode mode : {GatherMode::Lists, GatherMode::Interleaved}) {
    const Image one = firstFrame(with(settings, mode, 0), room.scene.view());
    errors[mode == GatherMode::Interleaved] = relativeRmse(one, all);
    EXPECT_NEAR(meanLuminance(one), meanLuminance(all), 0.01 * meanLuminance(all));
  }
  std::printf("one frame, 64 lights by lists: %.4f, 128 of a class: %.4f\n", errors[0], errors[1]);
  EXPECT_LT(errors[0], 0.6 * errors[1]);
  Viewer gi(with(settings, GatherMode::Lists, 64));
  gi.run(room.scene.view());
  while (gi.run(still()).plan.on(EffectId::Redraw)) {
  }
  const double rests = relativeRmse(gi.read(Buffer::Irradiance), all);
  std::printf("after 64 frames: %.4f\n", rests);
  EXPECT_LT(rests, 0.15 * errors[0]);
}

TEST_F(ListsTest, ListsGiveWayToClassesWhereAViewStands) {
  settings.smc.vpls = 256;
  for (const int frames : {64, 16}) {
    Viewer gi(with(settings, GatherMode::Lists, frames));
    EXPECT_EQ(gi.run(room.scene.view()).raysLists.closest, 0u) << "nothing moves yet";
    int drawn = 0, byLists = 0;
    while (gi.run(still()).plan.on(EffectId::Redraw)) ++drawn, byLists += gi.stats().raysLists.closest > 0;
    EXPECT_GE(drawn, frames - 1);
    EXPECT_EQ(byLists, 0) << "a mean that holds all classes";
    room.scene.camera.worldFromView[3].x += 0.01f;
    EXPECT_GT(gi.run(view(kCameraChanged)).raysLists.closest, 0u);
  }
}

/// By lists a small change is followed by what the lights know of it, and the mean is nearer to all lights than a frame
/// is.
TEST_F(ListsTest, ListsFollowWhatLightsKnow) {
  settings.gather.mode = GatherMode::Lists;
  settings.gather.lights = 16;
  settings.gather.near = 0;
  Viewer gi(settings);
  stand(gi, 8);
  for (int i = 0; i < 16; ++i) { // a tenth more in all
    room.scene.lights[0].intensity *= 1.006f;
    gi.run(view(kLightsChanged));
  }
  const Image last = gi.read(Buffer::Irradiance);
  gi.settings() = with(settings, GatherMode::Full, 0); // the same lights
  const Image all = nextFrame(gi, still());
  gi.settings() = with(settings, GatherMode::Lists, 0);
  const double mean = relativeRmse(last, all), one = relativeRmse(nextFrame(gi, still()), all);
  std::printf("lists, light changing: mean %.4f, one frame %.4f\n", mean, one);
  EXPECT_LT(mean, 0.7 * one);
  EXPECT_NEAR(meanLuminance(last), meanLuminance(all), 0.02 * meanLuminance(all));
}

} // namespace lambent::test::lists_test
