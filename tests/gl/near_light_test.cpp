// Near light in whole frames: what bounds leave to it, and how many rays are cast.
#include "gi/measure/error_parts.h"
#include "still_room.h"

namespace lambent::test::near_light_test {

class NearLightTest : public AveragedRoomTest {};

TEST_F(NearLightTest, DisksAreWiderWhereNearRaysAreCast) {
  const auto drawn = [&](int near, float disk, float nearDisk) {
    settings.gather.near = near;
    settings.gather.disk = disk;
    settings.gather.nearDisk = nearDisk;
    return firstFrame(settings, room.scene.view());
  };
  const Image near = drawn(8, 1, 4), lost = drawn(0, 1, 4);
  EXPECT_EQ(relativeRmse(near, drawn(8, 4, 1)), 0);
  EXPECT_GT(relativeRmse(near, drawn(8, 1, 1)), 0.001);
  EXPECT_EQ(relativeRmse(lost, drawn(0, 1, 1)), 0) << "nothing gives back what they take";
}

TEST_F(NearLightTest, TheNearLimitIsWiderWhereAViewStands) {
  settings.gather.near = 8;
  settings.gather.nearLimit = 0.25f;
  settings.gather.checks = false;
  settings.history.frames = 64;
  Viewer gi(settings);
  stand(gi, 64);
  Settings many = with(settings, GatherMode::Full, 0);
  many.gather.near = 256;
  const double narrow = meanLuminance(firstFrame(many, room.scene.view()));
  many.gather.nearLimit = 1;
  const double wide = meanLuminance(firstFrame(many, room.scene.view()));
  EXPECT_GT(wide, 1.02 * narrow);
  EXPECT_NEAR(meanLuminance(gi.read(Buffer::Irradiance)), wide, 0.25 * (wide - narrow));
}

/// By lists, more often than the others: three times what a still view casts while light changes, twice while only the
/// camera moves.
TEST_F(NearLightTest, ListsCastMoreRaysInMotion) {
  settings.gather.near = 32;
  settings.gather.disk = 1e-9f; // nothing is as near as that, so no ray goes on, and all pixels cast alike
  room.scene.size(48, 36);
  const auto castIn = [&](GatherMode mode, const SceneChanges& changes) {
    Viewer gi(with(settings, mode, 64));
    stand(gi, 2);
    const RayCounts& rays = gi.run(view(changes)).raysNear;
    // A ray finds what a pixel sees, by lists two: one before, to share rays out.
    const double casts = double(rays.closest) / (48 * 36) - (mode == GatherMode::Lists ? 2 : 1);
    if (changes.lights || changes.camera) {
      EXPECT_NEAR(nearRaysOfPixel(gi.settings(), changes.lights), casts, 0.02 * casts) << int(mode);
    }
    return casts;
  };
  const double still = castIn(GatherMode::Interleaved, kStill);
  EXPECT_NEAR(still, 2, 0.01);
  EXPECT_NEAR(castIn(GatherMode::Lists, kLightsChanged), 3 * still, 0.02 * still);
  EXPECT_NEAR(castIn(GatherMode::Lists, kCameraChanged), 2 * still, 0.02 * still);
  EXPECT_NEAR(castIn(GatherMode::Interleaved, kLightsChanged), 2 * still, 0.01);
  EXPECT_NEAR(castIn(GatherMode::Interleaved, kCameraChanged), still, 0.01);
  EXPECT_NEAR(castIn(GatherMode::Full, kLightsChanged), 2 * 32, 0.01) << "a pixel, not a block";
}

} // namespace lambent::test::near_light_test
