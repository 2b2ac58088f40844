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

/// Walls with wide texels, the block with narrow ones: twice the error of a cube that has these everywhere, from a
/// quarter of its entries.
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
  EXPECT_LT(differences[1], 0.2 * differences[0]);
  EXPECT_LT(differences[1], 2.5 * differences[2]);
  EXPECT_LT(double(entries[1]), 0.3 * double(entries[2]));
}

/// Four times the lights: pixels look up as much as before, and what keeps it up to date grows (paper 5, table 1).
TEST_F(CubeGatherTest, LookedUpMemoryIsThatOfFewLights) {
  settings.cube.resolution = 32;
  uint64_t bytes[2], kept[2];
  for (const int many : {0, 1}) {
    settings.smc.vpls = many ? 512 : 128;
    Viewer gi(settings);
    const FrameStats& stats = gi.run(room.scene.view());
    bytes[many] = stats.cubeBytes;
    kept[many] = stats.cubeKeptBytes;
  }
  EXPECT_GT(bytes[0], 0u);
  EXPECT_LE(double(bytes[1]), 1.1 * double(bytes[0]));
  EXPECT_GT(kept[1], kept[0]);
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

TEST_F(CubeGatherTest, ADarkRoomBesideALitOneStaysDark) {
  expectDarkBesideLit(settings, 0.01);
  settings.cube.visibility = CubeVisibility::Hemicubes;
  expectDarkBesideLit(settings, 0.01);
}

/// Entries of floors on either side of a thin wall lie in the same columns: linked, each would take the other's light.
TEST_F(CubeGatherTest, ThinWallsDivideColours) {
  HandScene scene;
  const uint32_t white = scene.material(vec3(0.7f));
  scene.box(vec3(-1), vec3(1), white, true);
  scene.box(vec3(-0.005f, -1, -1), vec3(0.005f, 1, 1), white, false);
  scene.lamp({-0.6f, 0.5f, 0}, vec3(2, 0, 0));
  scene.lamp({0.6f, 0.5f, 0}, vec3(0, 2, 0));
  settings.cube.resolution = 16;
  for (const float side : {-1.0f, 1.0f}) {
    scene.camera = cameraAt(vec3(0.9f * side, 0.2f, 0.8f), vec3(0.05f * side, -1, -0.2f), 0.9f, 64, 48);
    const Image light = firstFrame(settings, scene.view());
    for (const vec3& e : light.pixels) ASSERT_LT(side < 0 ? e.y : e.x, 1e-3f * (e.x + e.y)) << side;
    EXPECT_GT(meanLuminance(light), 0.01);
  }
}

/// An attic without light, whose floor is far thinner than a texel, over a lit room with a panel under its ceiling:
/// what the light reaches there faces up as the attic's floor does.
TEST_F(CubeGatherTest, AThinFloorKeepsTheLightBelow) {
  HandScene scene;
  const uint32_t white = scene.material(vec3(0.7f));
  scene.box(vec3(-1), vec3(1), white, true);
  scene.box(vec3(-1.01f, 0.49f, -1.01f), vec3(1.01f, 0.5f, 1.01f), white, false);
  scene.box(vec3(-0.4f, 0.46f, -0.4f), vec3(0.4f, 0.47f, 0.4f), white, false);
  scene.lamp({0.3f, -0.2f, 0.2f}, vec3(4));
  scene.lamp({0, 0.48f, 0}, vec3(0.01f)); // between panel and ceiling
  settings.cube.resolution = 24;
  scene.camera = cameraAt(vec3(0, 0.9f, 0.9f), vec3(0, 0.5f, -0.1f), 1.2f, 64, 48);
  const Image attic = firstFrame(settings, scene.view()), normal = firstFrame(settings, scene.view(), Buffer::Normal);
  size_t floor = 0;
  for (size_t i = 0; i < attic.pixels.size(); ++i)
    if (normal.pixels[i].y > 0.9f) { // walls are lit to a texel above it (gi/README, known issues)
      ++floor;
      ASSERT_EQ(attic.pixels[i], vec3(0));
    }
  EXPECT_GT(floor, 1000u);
  scene.camera = cameraAt(vec3(0, 0, 0.9f), vec3(0, -1, 0), 1.2f, 64, 48);
  EXPECT_GT(meanLuminance(firstFrame(settings, scene.view())), 0.1);
}

/// Slanted sides of a slab that is lower than the rays of a texel are apart: they take the light of its top. (Upright
/// ones are black: with light of any side, walls that no ray met shone.)
TEST_F(CubeGatherTest, SidesThatNoRayMetAreNotBlack) {
  HandScene scene;
  const uint32_t white = scene.material(vec3(0.7f));
  scene.box(vec3(-1), vec3(1), white, true);
  scene.quad({-0.5f, -1, 0.505f}, {1, 0, 0}, {0, 0.015f, -0.005f}, white);
  scene.quad({-0.5f, -0.985f, 0.5f}, {1, 0, 0}, {0, 0, -1}, white);
  scene.lamp({0.3f, 0.6f, 0.4f}, vec3(2));
  scene.camera = cameraAt(vec3(0, -0.8f, 0.95f), vec3(0, -0.99f, 0.5f), 0.3f, 96, 64);
  settings.cube.resolution = 16;
  const Image light = firstFrame(settings, scene.view()), normal = firstFrame(settings, scene.view(), Buffer::Normal),
              plain = (applyTechnique(settings, "ir"), settings.vpl.visibility = VplVisibility::Rays,
                       firstFrame(settings, scene.view()));
  int side = 0;
  double sum = 0, expected = 0;
  for (size_t i = 0; i < light.pixels.size(); ++i) {
    if (normal.pixels[i].z < 0.9f) continue;
    ++side;
    EXPECT_GT(light.pixels[i].x, 0);
    sum += double(light.pixels[i].x), expected += double(plain.pixels[i].x);
  }
  EXPECT_GT(side, 200);
  EXPECT_NEAR(sum / expected, 1, 0.5);
}

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
  // A damaged one, one of other settings, of fewer lights, of another scene: said, built anew and replaced.
  settings.cubeFile = file.string();
  for (const std::string what : {"damaged", "other settings (cube", "smc.vpls", "another scene"}) {
    if (what == "damaged") writeBytes(file, readBytes(file).replace(4000, 1, "\x5a"));
    if (what == "other settings (cube") settings.gather.disk = 2.5f;
    if (what == "smc.vpls") settings.smc.vpls /= 2;
    if (what == "another scene") room.scene.instances.pop_back();
    Viewer anew(settings), without((plainSettings = settings, plainSettings.cubeFile.clear(), plainSettings));
    const std::string warning = anew.run(room.scene.view()).warning;
    EXPECT_NE(warning.find(what), std::string::npos) << warning;
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
