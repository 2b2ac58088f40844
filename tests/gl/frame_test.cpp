// The frame as a whole, through the interface that programs use.
#include "frames.h"

namespace lambent::test::frame_test {

class FrameTest : public GlTest {
 protected:
  /// A white room with a red and a green wall, a block, and a lamp; the camera looks along -z.
  FrameTest() {
    const uint32_t white = scene.material(vec3(0.7f));
    scene.box({-1.5f, 0, -1.5f}, {1.5f, 2.5f, 1.5f}, white, true);
    scene.instances.erase(scene.instances.begin(), scene.instances.begin() + 2);
    scene.quad({-1.5f, 0, -1.5f}, {0, 2.5f, 0}, {0, 0, 3}, scene.material({0.7f, 0.1f, 0.1f}));
    scene.quad({1.5f, 0, -1.5f}, {0, 0, 3}, {0, 2.5f, 0}, scene.material({0.1f, 0.6f, 0.1f}));
    scene.box({-0.9f, 0, -0.9f}, {-0.1f, 1.1f, -0.2f}, white, false);
    scene.lamp({0.5f, 2.1f, 0.2f}, vec3(4));
    scene.camera = cameraAt({0, 1.2f, 1.45f}, {0, 1.2f, 0}, 1.2f, 96, 72);
  }

  HandScene scene;

  static Settings quick() {
    Settings s;
    s.smc = {.vpls = 1024, .points = 1024, .warmup = 20};
    s.shadow.maker = ShadowMaker::Rays;
    s.debug.timing = TimingMode::Finish;
    s.image.exposure = 1;
    return s;
  }
};

TEST_F(FrameTest, MapsAndInterleavingStayCloseToARayForEveryPair) {
  Settings settings = quick();
  settings.history.frames = 0;
  settings.gather.mode = GatherMode::Interleaved;
  Viewer gi(settings);
  const Image interleaved = nextFrame(gi, scene.view());
  gi.settings().smc.moves = 0; // the same lights for all three
  gi.settings().gather.mode = GatherMode::Full;
  const Image full = nextFrame(gi, scene.view(kStill));
  gi.settings().vpl.visibility = VplVisibility::Rays;
  const Image rays = nextFrame(gi, scene.view(kStill));
  EXPECT_GT(meanLuminance(rays), 0.1);
  // Measured 0.9 % and 4.1 %: shadow maps of 128 texels blur edges, interleaving and its filter blur more.
  expectClose("full-against-rays", full, rays, 0.02);
  expectClose("interleaved-against-rays", interleaved, rays, 0.07);
  EXPECT_NEAR(meanLuminance(interleaved), meanLuminance(rays), 0.02 * meanLuminance(rays));
}

/// What is said of techniques that wait (isr) is in counts_test.cpp; all others never stand still after the first
/// frame, which measures the exposure, but to ask which shadows are in doubt.
TEST_F(FrameTest, NoFrameWaitsForTheGpu) {
  Settings settings = quick();
  settings.smc.vpls = settings.smc.points = 64;
  settings.smc.warmup = 2;
  settings.shadow.resolution = 32;
  scene.size(48, 36);
  settings.image.exposure = 0;
  settings.debug.timing = TimingMode::Queries; // glFinish around passes would hide what waits
  for (const VplSource source : {VplSource::Smc, VplSource::Rsm, VplSource::Hisr})
    for (const GatherMode mode :
         {GatherMode::Lists, GatherMode::Interleaved, GatherMode::Multires, GatherMode::Splat}) {
      settings.vpl.source = source;
      settings.vpl.visibility = source == VplSource::Smc ? VplVisibility::Maps : VplVisibility::None;
      settings.gather.mode = mode;
      if (!whyNot(settings).empty()) continue;
      settings.shadow.rays = false;
      Viewer gi(settings);
      const FrameStats first = gi.run(scene.view());
      EXPECT_EQ(first.readBacks, 1u);
      for (const bool rays : {false, true}) {
        gi.settings().shadow.rays = rays;
        for (int frame = 0; frame < 8; ++frame) { // twice around what buffers hold at once
          const FrameStats& stats = gi.run(scene.view(frame % 2 ? kLightsChanged : kCameraChanged));
          EXPECT_EQ(stats.raysLists.closest > 0, mode == GatherMode::Lists);
          EXPECT_GT(stats.draws, 3u);
          EXPECT_EQ(stats.waits, 0u) << frame;
          EXPECT_EQ(stats.readBacks, rays ? 2u : 0u);
        }
      }
    }
}

/// A lamp that becomes four times as bright is followed, half of the way in image.adaptation, but not farther than to a
/// 64th; without it, or without time, the first frame's exposure stays.
TEST_F(FrameTest, ExposureAdaptsToTheLight) {
  Settings settings = quick();
  settings.image.exposure = 0;
  settings.effects[EffectId::Indirect] = EffectMode::Off; // so that light is as the lamp is
  settings.shadow.rays = false;                           // which reads back too
  const auto times = [&](float brighter) {
    scene.lights[0].intensity = vec3(4 * brighter);
    return scene.view(kLightsChanged);
  };
  Viewer gi(settings);
  gi.run(scene.view());
  const float first = gi.exposure();
  EXPECT_GT(first, 0);
  gi.passTime(1);
  gi.run(times(4));
  EXPECT_EQ(gi.exposure(), first) << "it is off";
  gi.settings().image.adaptation = 2;
  gi.run(times(4)); // measured here
  EXPECT_EQ(gi.exposure(), first) << "no time has gone by";
  gi.passTime(2);
  EXPECT_EQ(gi.run(times(4)).readBacks, 1u) << "a small grid, before the frame";
  EXPECT_NEAR(gi.exposure(), first / 2, 0.02f * first) << "half of the way, in stops";
  const auto rests = [&](float wanted, const char* why) {
    float distance = std::abs(std::log(gi.exposure() / wanted));
    for (int i = 0; i < 40; ++i) {
      gi.passTime(1);
      gi.run(scene.view(kStill)); // nothing is drawn any more
      const float now = std::abs(std::log(gi.exposure() / wanted));
      EXPECT_LE(now, distance + 1e-4f) << why;
      distance = now;
    }
    EXPECT_NEAR(gi.exposure(), wanted, 0.02f * wanted) << why;
  };
  rests(first / 4, "all of the way");
  gi.run(times(1000)); // one frame is enough to see it
  rests(first / 64, "no farther");
  gi.run(times(0));
  rests(first / 64, "black asks for nothing");
  gi.settings().image.exposure = 3;
  gi.run(times(1));
  EXPECT_EQ(gi.exposure(), 3);
  gi.settings().image.adaptation = 0;
  gi.settings().image.exposure = 0;
  gi.run(scene.view(kStill));
  EXPECT_NEAR(gi.exposure(), first, 0.02f * first) << "measured again, though nothing is drawn";
}

/// What the first frame with light asks for is what exposure keeps to, not a black one before it.
TEST_F(FrameTest, ExposureAdaptsFromBlack) {
  Settings settings = quick();
  settings.image.exposure = 0;
  settings.image.adaptation = 2;
  settings.effects[EffectId::Indirect] = EffectMode::Off;
  scene.lights[0].intensity = vec3(0);
  Viewer gi(settings);
  gi.run(scene.view());
  EXPECT_EQ(gi.exposure(), 1);
  scene.lights[0].intensity = vec3(4e4f);
  gi.run(scene.view(kLightsChanged));
  gi.passTime(1000);
  gi.run(scene.view(kStill));
  EXPECT_LT(gi.exposure(), 1e-3f);
}

TEST_F(FrameTest, TheSameTwice) {
  const auto second = [&] {
    Viewer gi(quick());
    gi.run(scene.view());
    return nextFrame(gi, scene.view(kStill), Buffer::Beauty);
  };
  EXPECT_EQ(relativeRmse(second(), second()), 0);
}

TEST_F(FrameTest, ACameraCutIsLitInItsFirstFrame) {
  // A second, closed room ten metres away, blue, with a lamp of its own.
  scene.box({8.5f, 0, -1.5f}, {11.5f, 2.5f, 1.5f}, scene.material({0.2f, 0.3f, 0.8f}), true);
  scene.lamp({10, 2, 0}, vec3(4));
  Viewer gi(quick());
  gi.run(scene.view());
  scene.camera.worldFromView[3].x += 10;
  EXPECT_TRUE(gi.run(scene.view(kCameraChanged)).burst);
  const Image first = gi.read(Buffer::Irradiance);
  for (int i = 0; i < 10; ++i) gi.run(scene.view(kStill));
  const Image later = gi.read(Buffer::Irradiance);
  EXPECT_NEAR(meanLuminance(first), meanLuminance(later), 0.1 * meanLuminance(later));
}

TEST_F(FrameTest, StagesThatTheSceneDoesNotCallForDoNotRun) {
  scene.lights.clear();
  Viewer gi(quick());
  const FrameStats& dark = gi.run(scene.view());
  EXPECT_EQ(dark.raysRadiosity.closest + dark.raysRadiosity.occlusion + dark.raysCandidates.closest, 0u);
  EXPECT_EQ(dark.mapsDrawn, 0u);
  EXPECT_EQ(meanLuminance(gi.read(Buffer::Beauty)), 0);
  for (const StageTime& s : dark.stages) EXPECT_FALSE(s.stage == key(StageId::Gather));
}

/// A floor under a sheet that is all cut out sends light to nothing, and its slots stay empty; a wall that comes is lit
/// as if it had been there.
TEST_F(FrameTest, SlotsWithoutALightHaveNoMap) {
  HandScene open;
  open.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, open.material(vec3(0.7f)));
  const uint32_t sheet = open.material(vec3(0.7f), vec3(0), true);
  open.assets.materials[sheet].alphaMode = AlphaMode::Mask, open.assets.materials[sheet].alpha = 0.1f;
  open.quad({-1, 0.8f, 1}, {2, 0, 0}, {0, 0, -2}, sheet);
  open.quad({-2, -4, -1}, {4, 0, 0}, {0, 2, 0}, open.material(vec3(0.7f))); // the wall, beneath the floor
  open.lamp({0.5f, 1.5f, 0.2f}, vec3(4));
  open.camera = cameraAt({0, 1.2f, 2.5f}, {0, 0, -0.5f}, 1.2f, 96, 72);
  Viewer gi(quick());
  const FrameStats& stats = gi.run(open.view());
  EXPECT_TRUE(stats.plan.on(EffectId::Indirect));
  EXPECT_EQ(stats.vplsAlive, 0u);
  EXPECT_EQ(stats.mapsDrawn, 0u);
  open.place(uint32_t(open.instances.size() - 1), glm::translate(mat4(1), vec3(0, 4, 0)));
  const double later = meanLuminance(nextFrame(gi, open.view({.first = false}), Buffer::Irradiance));
  EXPECT_GT(stats.vplsAlive, 100u);
  EXPECT_EQ(stats.mapsDrawn, stats.vplsAlive);
  Viewer other(quick());
  const double fresh = meanLuminance(nextFrame(other, open.view(), Buffer::Irradiance));
  EXPECT_GT(fresh, 0.01);
  EXPECT_NEAR(later, fresh, 0.1 * fresh);
}

TEST_F(FrameTest, MovingObjectsAndLightsStayFinite) {
  Settings settings = quick();
  settings.smc.vpls = settings.smc.points = 256;
  Viewer gi(settings);
  gi.run(scene.view());
  for (int frame = 0; frame < 60; ++frame) {
    scene.place(uint32_t(scene.instances.size() - 1),
                glm::translate(mat4(1), vec3(0.3f * std::sin(0.2f * float(frame)), 0, 0)));
    scene.lights[0].position.x = std::cos(0.1f * float(frame));
    const Image image =
        nextFrame(gi, scene.view({.first = false, .camera = false, .instances = false}), Buffer::Beauty);
    for (const vec3& p : image.pixels) ASSERT_TRUE(isFinite(p)) << "frame " << frame;
  }
}

} // namespace lambent::test::frame_test
