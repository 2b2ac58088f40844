// Technique ibrr: the layered depth cube that pixels look light up in.
#include "frames.h"
#include "tests/support/files.h"

namespace lambent::test::cube_gather_test {

class CubeGatherTest : public GlTest {
 protected:
  CubeGatherTest() {
    room.scene.lamp({0.3f, 0.6f, 0.4f}, vec3(2));
    applyTechnique(settings, "ibrr");
    settings.smc = {.vpls = 256, .bounces = 2};
    settings.cube.resolution = 64;
    settings.gather.near = 0;
    settings.image.exposure = 1;
  }
  SceneView still() const { return room.scene.view(kStill); }
  /// A ray for every pixel and light.
  Image byRays() const {
    Settings every = settings;
    applyTechnique(every, "ir");
    every.vpl.visibility = VplVisibility::Rays;
    every.filter.on = false;
    every.history.frames = 0;
    return firstFrame(every, room.scene.view());
  }

  Room room;
  Settings settings;
};

/// The same lights, with a ray for every pixel and light.
TEST_F(CubeGatherTest, GivesThePicturesOfItsLights) {
  const Image cube = firstFrame(settings, room.scene.view());
  const Image rays = byRays();
  const double difference = relativeDifference(cube, rays);
  std::printf("mean difference from a ray for every pixel and light: %.2f %%\n", 100 * difference);
  EXPECT_LT(difference, 0.03);
  EXPECT_NEAR(meanLuminance(cube) / meanLuminance(rays), 1, 0.01);
  size_t dark = 0; // cracks
  for (size_t i = 0; i < cube.pixels.size(); ++i) dark += luminance(cube.pixels[i]) < 0.3f * luminance(rays.pixels[i]);
  EXPECT_LE(dark, 2u);
}

/// Walls with wide texels, the block with narrow ones: nearly as near as one cube that has these everywhere.
TEST_F(CubeGatherTest, ATreeComesNearAFinerCube) {
  const Image rays = byRays();
  struct Kind {
    int resolution, levels;
  };
  double differences[3];
  uint64_t entries[3];
  constexpr Kind kKinds[3] = {{16, 0}, {16, 3}, {128, 0}};
  for (int k = 0; k < 3; ++k) {
    settings.cube.resolution = kKinds[k].resolution;
    settings.cube.levels = kKinds[k].levels;
    Viewer gi(settings);
    entries[k] = gi.run(room.scene.view()).cubeEntries;
    differences[k] = relativeDifference(gi.read(Buffer::Irradiance), rays);
    std::printf("%d texels, %d levels: %.2f %%, %llu entries\n", kKinds[k].resolution, kKinds[k].levels,
                100 * differences[k], static_cast<unsigned long long>(entries[k]));
  }
  EXPECT_LT(differences[1], 0.5 * differences[0]);
  EXPECT_LT(entries[1], entries[2] / 2);
}

/// While nothing but the camera moves a frame draws surfaces and looks up.
TEST_F(CubeGatherTest, AMovingCameraAsksNoRayAndLightsNothing) {
  Viewer gi(settings);
  gi.run(room.scene.view());
  for (int frame = 0; frame < 3; ++frame) {
    room.scene.camera.worldFromView[3].x += 0.02f;
    const FrameStats& stats = gi.run(room.scene.view(kCameraChanged));
    EXPECT_EQ(stats.raysCube.closest + stats.raysCube.occlusion + stats.raysCandidates.closest, 0u);
    EXPECT_FALSE(stats.plan.on(EffectId::Replace)) << stats.plan[EffectId::Replace].reason;
    EXPECT_FALSE(stats.plan.on(EffectId::Relight));
    EXPECT_TRUE(stats.plan.on(EffectId::Redraw));
    EXPECT_EQ(gi.read(Buffer::Irradiance).pixels, firstFrame(settings, room.scene.view()).pixels) << frame;
  }
}

/// After a lamp and the block moved the picture is that of a cube built there.
TEST_F(CubeGatherTest, FollowsLampsAndObjects) {
  Viewer gi(settings);
  gi.run(room.scene.view());
  room.scene.lights[0].position.x = -0.3f;
  gi.run(room.scene.view(kLightsChanged));
  room.scene.move(Room::kBlock, {0.3f, 0, 0.2f});
  const FrameStats& stats = gi.run(room.scene.view(kGeometryChanged));
  EXPECT_GT(stats.raysCube.occlusion, 0u);
  const Image kept = gi.read(Buffer::Irradiance), fresh = firstFrame(settings, room.scene.view());
  EXPECT_LT(relativeDifference(kept, fresh), 1e-3);
  Room other;
  other.scene.lights = room.scene.lights;
  EXPECT_GT(relativeDifference(firstFrame(settings, other.scene.view()), fresh), 0.05)
      << "the block makes a difference";
}

/// The cube comes where nothing changes for long, goes where a lamp moves, and neither is seen.
TEST_F(CubeGatherTest, StandsInWhereNothingChanges) {
  settings = {};
  settings.smc = {.vpls = 512, .bounces = 2};
  settings.image.exposure = 1;
  settings.cube.resolution = 64;
  settings.stillCache = {.after = 20, .perFrame = 64};
  Viewer gi(settings);
  gi.run(room.scene.view());
  double mean = 0, most = 0;
  const auto step = [&](bool counts) {
    const double now = meanLuminance(gi.read(Buffer::Irradiance));
    if (counts) most = std::max(most, std::abs(now / mean - 1));
    mean = now;
  };
  step(false);
  int alone = 0, frames = 0;
  for (; frames < 200 && alone < 3; ++frames) {
    const FrameStats& stats = gi.run(still());
    EXPECT_TRUE(frames + 1 >= settings.stillCache.after || stats.raysCube.closest == 0) << frames;
    alone += !stats.plan.on(EffectId::Gather);
    step(frames > 5); // before, the history is short
  }
  ASSERT_EQ(alone, 3);
  EXPECT_GT(frames, settings.stillCache.after + 16 + 4);
  const Image cube = gi.read(Buffer::Irradiance);
  Settings own = settings;
  applyTechnique(own, "ibrr");
  EXPECT_EQ(cube.pixels, firstFrame(own, room.scene.view()).pixels) << "the light of ibrr";
  EXPECT_FALSE(gi.run(still()).plan.on(EffectId::Redraw)) << "and then nothing is done";

  // The camera alone: no light is sampled, no map drawn, nothing gathered.
  const mat4 pose = room.scene.camera.worldFromView;
  room.scene.camera.worldFromView[3].x += 0.05f;
  const FrameStats& walk = gi.run(room.scene.view(kCameraChanged));
  EXPECT_FALSE(walk.plan.on(EffectId::Gather));
  EXPECT_FALSE(walk.plan.on(EffectId::Replace));
  EXPECT_EQ(walk.raysCandidates.closest + walk.raysCube.closest + walk.mapsDrawn, 0u);
  room.scene.camera.worldFromView = pose;
  gi.run(room.scene.view(kCameraChanged));
  step(false);

  room.scene.lights[0].position.x += 0.01f;
  EXPECT_TRUE(gi.run(room.scene.view(kLightsChanged)).plan.on(EffectId::Gather));
  step(true);
  for (int f = 0; f < 18; ++f) {
    EXPECT_TRUE(gi.run(still()).plan.on(EffectId::Gather));
    step(true);
  }
  std::printf("largest step of mean light from frame to frame: %.2f %%\n", 100 * most);
  EXPECT_LT(most, 0.02);
}

/// A cube that is wanted again before it is gone shows the light of now, and settings may change while it stands in.
TEST_F(CubeGatherTest, StandsInWithTheLightOfNow) {
  settings = {};
  settings.smc = {.vpls = 128, .bounces = 2};
  settings.image.exposure = 1;
  settings.cube.resolution = 32;
  settings.stillCache = {.after = 4, .perFrame = 256};
  Viewer gi(settings);
  gi.run(room.scene.view());
  const auto untilAlone = [&] {
    for (int f = 0; f < 200; ++f)
      if (!gi.run(still()).plan.on(EffectId::Gather)) return;
    FAIL() << "it never stands in";
  };
  const auto isThatOfNow = [&](const char* when) {
    Settings own = gi.settings();
    applyTechnique(own, "ibrr");
    EXPECT_EQ(gi.read(Buffer::Irradiance).pixels, firstFrame(own, room.scene.view()).pixels) << when;
  };
  untilAlone();
  room.scene.lights[0].position.x = -0.4f;
  gi.run(room.scene.view(kLightsChanged));
  untilAlone();
  isThatOfNow("after a lamp moved");
  gi.settings().gather.disk = 2;
  EXPECT_TRUE(gi.run(still()).plan.on(EffectId::Gather));
  untilAlone();
  isThatOfNow("after a setting changed");
  gi.settings().stillCache.after = 0;
  for (int f = 0; f < 20; ++f) EXPECT_TRUE(gi.run(still()).plan.on(EffectId::Gather));
  gi.settings().stillCache.after = 4;
  gi.settings().effects[EffectId::Gather] = EffectMode::Off;
  for (int f = 0; f < 12; ++f) gi.run(still());
}

TEST_F(CubeGatherTest, ADarkRoomBesideALitOneStaysDark) { expectDarkBesideLit(settings, 0.01); }

TEST_F(CubeGatherTest, AFileKeepsItBetweenRuns) {
  const TemporaryFolder folder;
  const fs::path file = folder / "room.cube";
  settings.cubeFile = file.string();
  Settings plainSettings;
  Image first;
  for (int run = 0; run < 2; ++run) {
    Viewer gi(settings);
    const FrameStats& stats = gi.run(room.scene.view());
    EXPECT_EQ(stats.raysCube.occlusion > 0, run == 0);
    if (run == 0)
      first = gi.read(Buffer::Irradiance);
    else
      EXPECT_EQ(gi.read(Buffer::Irradiance).pixels, first.pixels);
  }
  // Another lamp: the file's lights are not shown.
  room.scene.lights[0].position.x = -0.5f;
  Viewer moved(settings), plain((settings.cubeFile.clear(), settings));
  moved.run(room.scene.view());
  plain.run(room.scene.view());
  EXPECT_LT(relativeDifference(moved.read(Buffer::Irradiance), plain.read(Buffer::Irradiance)), 1e-3);
  // A damaged one, and one of another scene: said, built anew and replaced.
  settings.cubeFile = file.string();
  for (const bool damaged : {true, false}) {
    if (damaged) {
      writeBytes(file, readBytes(file).replace(4000, 1, "\x5a"));
    } else {
      room.scene.instances.pop_back();
    }
    Viewer anew(settings), without((plainSettings = settings, plainSettings.cubeFile.clear(), plainSettings));
    const std::string warning = anew.run(room.scene.view()).warning;
    EXPECT_NE(warning.find(damaged ? "damaged" : "another scene"), std::string::npos) << warning;
    without.run(room.scene.view());
    EXPECT_EQ(anew.read(Buffer::Irradiance).pixels, without.read(Buffer::Irradiance).pixels);
    Viewer again(settings);
    const FrameStats& stats = again.run(room.scene.view());
    EXPECT_EQ(stats.warning, "");
    EXPECT_EQ(stats.raysCube.occlusion, 0u);
  }
  // What is no cube is not touched.
  writeBytes(file, "{\"asset\": {\"version\": \"2.0\"}}");
  EXPECT_NE(Viewer(settings).run(room.scene.view()).warning, "");
  EXPECT_EQ(fs::file_size(file), 29u);
}

} // namespace lambent::test::cube_gather_test
