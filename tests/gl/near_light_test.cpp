// Near light in whole frames: what bounds leave to it, and how many rays are cast.
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

} // namespace lambent::test::near_light_test
