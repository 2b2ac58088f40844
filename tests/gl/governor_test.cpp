// The governor over real frames: its clock counts work (pixels, virtual lights, punctual lights), so that it says the
// same on every machine; the pictures are real.
#include "frames.h"
#include "gi/plan/governor.h"

namespace lambent::test::governor_test {

using GovernorFrames = GlTest;
constexpr double kTarget = 20;

TEST_F(GovernorFrames, FollowLoadStepsWithoutChangingBrightness) {
  Room room;
  room.scene.size(96, 64);
  LightView lamp = room.scene.lamp({0.5f, 0.7f, 0.4f}, vec3(2));
  Settings settings;
  settings.smc.vpls = 512;
  settings.shadow.resolution = 64;
  settings.gather.near = 0; // a thousand pixels have noise of their own
  settings.image.exposure = 1;
  settings.effects[EffectId::Redraw] = EffectMode::On;
  Governed g;
  g.settings = settings;
  g.choosesPreset = false;
  Viewer gi(settings);
  const CameraView first = room.scene.camera;
  double load = 1, largest = 0;
  int changes = 0;
  std::vector<double> ms;
  CameraView whole = first;
  bool begins = true;

  const auto run = [&](int frames, const char* what) {
    SCOPED_TRACE(what);
    ms.clear();
    int changesLate = 0;
    double before = 0;
    float scale = g.scale;
    for (int i = 0; i < frames; ++i) {
      room.scene.camera = whole.scaled(g.scale);
      const SceneView view = room.scene.view(
          {.first = begins, .camera = g.scale != scale, .lights = i == 0, .geometry = begins, .instances = begins});
      begins = false;
      const double mean = meanLuminance(nextFrame(gi, view, Buffer::Indirect));
      if (i > 0 && g.scale != scale) { // this frame is the first at another scale
        largest = std::max(largest, std::abs(mean / before - 1));
        ++changes;
        changesLate += i > frames / 2;
      }
      before = mean, scale = g.scale;
      const double pixels = double(room.scene.camera.width) * room.scene.camera.height;
      ms.push_back(load * (3 + 12 * pixels / (96 * 64) + double(room.scene.lights.size())));
      g = governed(std::move(g), ms.back(), kTarget);
    }
    EXPECT_EQ(changesLate, 0);
    EXPECT_NEAR(ms.back(), kTarget, 0.2 * kTarget);
  };
  whole.width *= 2, whole.height *= 2;
  run(60, "a window of four times the pixels");
  load = 1.7;
  run(60, "another program");
  lamp.intensity = vec3(1e-3f); // the others' light is to be compared before and after
  for (int i = 0; i < 3; ++i) room.scene.lights.push_back(lamp);
  run(60, "three more lamps");
  load = 1;
  run(60, "the other program ends");
  EXPECT_GE(changes, 4);
  EXPECT_LT(largest, 0.01);
  RecordProperty("largest_change", std::to_string(largest));
  std::printf("%d changes of scale, mean indirect light by %.2f %% at most\n", changes, 100 * largest);
}

} // namespace lambent::test::governor_test
