// Light averaged over pictures: what it comes to in a still view, while the camera moves, and when light changes.
#include "gi/plan/techniques.h"
#include "still_room.h"

namespace lambent::test::history_test {

class HistoryTest : public AveragedRoomTest {};

TEST_F(HistoryTest, AStillViewComesToHoldEveryLightAndSleeps) {
  Viewer gi(settings);
  gi.run(room.scene.view());
  const Image all = allLights();
  const double first = relativeRmse(gi.read(Buffer::Irradiance), all);
  double before = first;
  for (int i = 1; i < 16; ++i) {
    EXPECT_TRUE(gi.run(still()).plan.on(EffectId::Redraw)) << i;
    const double error = relativeRmse(gi.read(Buffer::Irradiance), all);
    EXPECT_LT(error, 1.02 * before) << i << ": patterns are taken in an order, and some say less than others";
    before = error;
  }
  EXPECT_GT(first, 0.01) << "the filter blurs";
  EXPECT_LT(relativeRmse(gi.read(Buffer::Irradiance), all), 1e-4);
  const FrameStats& asleep = gi.run(still());
  EXPECT_FALSE(asleep.plan.on(EffectId::Redraw)) << asleep.plan[EffectId::Redraw].reason;
  EXPECT_LT(relativeRmse(gi.read(Buffer::Irradiance), all), 1e-4);
}

TEST_F(HistoryTest, NearLightIsAveragedToo) {
  settings.gather.near = 8;
  settings.gather.nearLimit = 0;
  settings.history.frames = 64;
  Settings many = with(settings, GatherMode::Full, 0);
  many.gather.near = 256;
  Viewer gi(settings);
  stand(gi, 64);
  const Image expected = firstFrame(many, room.scene.view()), averaged = gi.read(Buffer::Irradiance),
              one = firstFrame(with(settings, GatherMode::Interleaved, 0), room.scene.view());
  // One pattern for all pixels, unmixed: 0.52.
  EXPECT_LT(relativeRmse(averaged, expected), 0.48 * relativeRmse(one, expected));
  EXPECT_NEAR(meanLuminance(averaged), meanLuminance(expected), 0.01 * meanLuminance(expected));
}

TEST_F(HistoryTest, FollowsTheCamera) {
  Viewer gi(settings);
  gi.run(room.scene.view());
  for (int i = 0; i < 24; ++i) { // past the block, one to two pixels a picture, and turning
    mat4& pose = room.scene.camera.worldFromView;
    pose = glm::rotate(pose, 0.01f, vec3(0, 1, 0));
    pose[3].x += 0.015f;
    gi.run(view(kCameraChanged));
  }
  const Image last = gi.read(Buffer::Irradiance);
  gi.settings() = with(settings, GatherMode::Interleaved, 0); // the same lights
  const Image one = nextFrame(gi, still());
  gi.settings() = with(settings, GatherMode::Full, 0);
  const Image all = nextFrame(gi, still());
  const double moving = relativeRmse(last, all), single = relativeRmse(one, all);
  EXPECT_LT(moving, 0.95 * single);
  EXPECT_NEAR(meanLuminance(last), meanLuminance(all), 0.01 * meanLuminance(all));
}

/// What comes into sight beside a near surface has not that surface's light.
TEST_F(HistoryTest, TakesNoLightFromOtherSurfaces) {
  room.scene.lights[0].position = {0.2f, 0.5f, -0.7f};
  const uint32_t white = room.scene.material(vec3(0.7f));
  for (int i = 0; i < 6; ++i) { // dark bars before the far wall
    const float x = -0.9f + 0.3f * float(i);
    room.scene.box({x, -1, 0.2f}, {x + 0.06f, 1, 0.26f}, white, false);
  }
  Viewer gi(settings);
  gi.run(room.scene.view());
  for (int i = 0; i < 12; ++i) {
    room.scene.camera.worldFromView[3].x += 0.02f;
    gi.run(view(kCameraChanged));
  }
  const Image last = gi.read(Buffer::Irradiance);
  gi.settings() = with(settings, GatherMode::Full, 0);         // the same lights
  EXPECT_LT(relativeRmse(last, nextFrame(gi, still())), 0.11); // 0.09; any plane taken: 0.13
}

TEST_F(HistoryTest, FollowsLightThatChanges) {
  Viewer gi(settings);
  stand(gi, 20);
  for (const float intensity : {4.0f, 0.25f, 0.3f}) { // twice at once, then by a fifth
    room.scene.lights[0].intensity = vec3(intensity);
    const double first = meanLuminance(nextFrame(gi, view(kLightsChanged))), wanted = meanLuminance(allLights());
    EXPECT_NEAR(first, wanted, 0.15 * wanted) << intensity;
    for (int i = 0; i < 4; ++i) gi.run(still());
    EXPECT_NEAR(meanLuminance(gi.read(Buffer::Irradiance)), wanted, 0.03 * wanted) << intensity;
    for (int i = 0; i < 60; ++i) gi.run(still());
    EXPECT_LT(relativeRmse(gi.read(Buffer::Irradiance), allLights()), 0.02) << intensity;
  }
}

/// The governor changes the picture's size while frames run: what is kept is looked up at the size that it has.
TEST_F(HistoryTest, TakesPicturesOfAnotherSizeAlong) {
  Viewer gi(settings);
  stand(gi, 16);
  for (const int width : {64, 48, 96}) {
    room.scene.size(width, width * 3 / 4);
    const Image all = allLights(), one = firstFrame(settings, room.scene.view());
    for (int i = 0; i < 3; ++i) { // the first of this size, and two that look up one of it
      const Image along = nextFrame(gi, view({false, i == 0, false, false, false}));
      const double most = width < 96 ? 0.8 : 1.1; // larger: of coarser pixels, but no worse than none
      EXPECT_LT(relativeRmse(along, all), most * relativeRmse(one, all)) << width << " " << i;
      EXPECT_NEAR(meanLuminance(along), meanLuminance(all), 0.01 * meanLuminance(all)) << width << " " << i;
    }
  }
}

/// After other settings or another scene the next picture is that of a frame that begins.
TEST_F(HistoryTest, ForgetsWhatIsNotItsOwn) {
  const auto asNew = [&](Viewer& gi, const Room& shown, const char* what) {
    EXPECT_EQ(gi.read(Buffer::Irradiance).pixels, firstFrame(gi.settings(), shown.scene.view()).pixels) << what;
  };
  Viewer gi(settings);
  stand(gi, 5);
  gi.settings().image.exposure = 2;
  gi.run(still());
  EXPECT_LT(relativeRmse(gi.read(Buffer::Irradiance), allLights()), 0.05) << "what does not gather otherwise";
  gi.settings().gather.disk = 0;
  gi.run(still());
  asNew(gi, room, "settings");
  for (int i = 1; i < 5; ++i) gi.run(still());
  Room other;
  other.scene.lights = room.scene.lights;
  other.scene.lights[0].intensity *= 0.9f;
  other.scene.camera = room.scene.camera;
  gi.run(other.scene.view());
  asNew(gi, other, "scene");
}

TEST_F(HistoryTest, GetsOverWhatIsNoNumber) {
  Viewer gi(settings);
  gi.run(room.scene.view());
  room.scene.lights[0].intensity = vec3(kInfinity);
  gi.run(view(kLightsChanged));
  room.scene.lights[0].intensity = vec3(1);
  for (int i = 0; i < 8; ++i) gi.run(view({false, false, i == 0, false, false}));
  EXPECT_NEAR(meanLuminance(gi.read(Buffer::Irradiance)), meanLuminance(allLights()),
              0.05 * meanLuminance(allLights()));
}

/// The history alone, of light that is given.
class HistoryPassTest : public GatherTest {
 protected:
  Image averaged(const GBuffer& gbuffer, std::span<const vec4> light, bool cameraMoved) {
    const gl::Texture given = textureOf(gbuffer.width, gbuffer.height, light);
    history.fit(gbuffer);
    const SurfaceLighting raw{&given, nullptr, false};
    return read(Buffer::Irradiance, gbuffer, raw, history.run({gbuffer, raw, cameraMoved, false, {.frames = 64}, {}}));
  }
  HistoryPass history{passes};
};

TEST_F(HistoryPassTest, CornersDoNotMix) {
  Room room;
  for (int i = 0; i < 12; ++i) {
    room.scene.camera.worldFromView[3].x += 0.003f; // part of a pixel
    room.scene.camera.worldFromView[3].y += 0.002f;
    const GBuffer gbuffer = surfaces(room.scene);
    const Image normal = surfaceBuffer(Buffer::Normal, gbuffer);
    const auto lit = [&](int x, int y) { return normal.at(x, y).y > 0.5f ? 1.0f : 0.0f; };
    std::vector<vec4> light(64 * 48);
    for (const auto [x, y] : Pixels(64, 48)) light[size_t(y) * 64 + x] = vec4(lit(x, 47 - y));
    const Image mean = averaged(gbuffer, light, i > 0);
    for (const auto [x, y] : Pixels(64, 48))
      ASSERT_NEAR(mean.at(x, y).x, lit(x, y), 1e-5f) << x << ' ' << y << ' ' << i;
  }
}

TEST_F(HistoryPassTest, WhatIsNoNumberCountsForOnePicture) {
  const Room room;
  const GBuffer gbuffer = surfaces(room.scene);
  std::vector<vec4> light(64 * 48, vec4(1));
  light[100].y = std::numeric_limits<float>::quiet_NaN();
  light[200].z = kInfinity;
  averaged(gbuffer, light, false);
  light.assign(light.size(), vec4(2));
  const Image mean = averaged(gbuffer, light, false);
  for (int i = 0; i < 64 * 48; ++i) {
    const vec3& e = mean.at(i % 64, 47 - i / 64);
    ASSERT_NEAR(e.x, i == 100 || i == 200 ? 2 : 1.5f, 1e-5f) << i;
    ASSERT_TRUE(isFinite(e)) << i;
  }
}

/// Forced on without need it does no work; switched off, everything is as with a history of no pictures.
TEST_F(HistoryTest, IsAnEffectOfThePlan) {
  settings.effects[EffectId::History] = EffectMode::On;
  settings.gather.mode = GatherMode::Full;
  Viewer full(settings);
  full.run(room.scene.view());
  EXPECT_EQ(full.run(still()).work[size_t(EffectId::History)], 0u);
  EXPECT_FALSE(full.run(still()).plan.on(EffectId::Redraw)) << "it sleeps";
  settings.effects[EffectId::History] = EffectMode::Off;
  settings.gather.mode = GatherMode::Interleaved;
  EXPECT_EQ(firstFrame(settings, room.scene.view()).pixels,
            firstFrame(with(settings, GatherMode::Interleaved, 0), room.scene.view()).pixels);
}

/// Every technique that gathers sixteenths comes to hold all of them.
TEST_F(HistoryTest, TurnsTheClassesOfEveryGather) {
  for (const char* technique : {"rsm", "hisr", "multires-gather"}) {
    Settings all;
    applyTechnique(all, technique);
    all.image.exposure = 1;
    all.rsm.resolution = 32;
    all.rsm.coarsest = all.rsm.finest = 16;
    all.multires.depth = 0;
    all.gather.mode = technique == std::string("multires-gather") ? GatherMode::Multires : GatherMode::Full;
    Settings part = all;
    part.gather.mode =
        technique == std::string("multires-gather") ? GatherMode::MultiresInterleaved : GatherMode::Interleaved;
    part.history.frames = 16;
    Viewer whole(all), turned(part);
    whole.run(room.scene.view());
    stand(turned, 16);
    EXPECT_LT(relativeRmse(turned.read(Buffer::Irradiance), whole.read(Buffer::Irradiance)), 2e-3) << technique;
  }
}

} // namespace lambent::test::history_test
