// Lights by lists against every light at every pixel, and where lists serve.
#include "gi/gather/light_change_pass.h"
#include "gi/gather/list_pass.h"
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
  std::printf("one frame, %d lights by lists: %.4f, %d of a class: %.4f\n", settings.gather.lights, errors[0],
              settings.smc.vpls / kLightClasses, errors[1]);
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

/// A first frame is of classes: behind one of lists it counts as the sixteenth that it is, and leaves no lattice.
TEST_F(ListsTest, AFirstFrameOfClassesCountsLittle) {
  settings.gather.near = 0;
  const Image all = allLights(), one = firstFrame(with(settings, GatherMode::Lists, 0), room.scene.view());
  Viewer gi(with(settings, GatherMode::Lists, 64));
  gi.run(room.scene.view());
  gi.run(view(kCameraChanged)); // by less than can be seen
  const double mean = relativeRmse(gi.read(Buffer::Irradiance), all), frame = relativeRmse(one, all);
  std::printf("lists after a frame of classes: %.4f, one frame of lists %.4f\n", mean, frame);
  EXPECT_LT(mean, 1.1 * frame);
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

/// The first change after a view stood is known: most of a step of a tenth shows in a few frames.
TEST_F(ListsTest, FollowsTheFirstStepAfterAViewStood) {
  settings.gather.mode = GatherMode::Lists;
  Viewer gi(settings);
  stand(gi, 20);
  const double before = meanLuminance(gi.read(Buffer::Irradiance));
  room.scene.lights[0].intensity *= 0.9f;
  gi.run(view(kLightsChanged));
  for (int i = 0; i < 2; ++i) gi.run(still());
  const double shown = meanLuminance(gi.read(Buffer::Irradiance)) / before;
  EXPECT_NEAR(shown, 0.9, 0.01);
}

/// What lights say holds as if nothing stood between: a lamp that flickers behind a wall does not shine through.
TEST_F(ListsTest, WhatFlickersBehindAWallStaysThere) {
  settings.gather.mode = GatherMode::Lists;
  room.scene.quad({0.05f, -1, -1}, {0, 2, 0}, {0, 0, 1.8f}, room.scene.material(vec3(0.7f), vec3(0), true));
  room.scene.lights[0].position = {-0.5f, 0.6f, 0.2f};
  room.scene.lamp({0.6f, 0.3f, -0.4f}, vec3(4));
  const auto meanLeft = [](const Image& image) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width / 3; ++x) sum += double(luminance(vec3(image.at(x, y))));
    return sum;
  };
  double shown[2], wanted[2];
  Viewer gi(settings);
  stand(gi, 20);
  for (int i = 0; i < 12; ++i) {
    room.scene.lights[1].intensity = vec3(i % 2 ? 4.0f : 0.8f);
    const double mean = meanLeft(nextFrame(gi, view(kLightsChanged)));
    if (i >= 10)
      shown[i % 2] = mean, wanted[i % 2] = meanLeft(firstFrame(with(settings, GatherMode::Full, 0), view({})));
  }
  std::printf("left of the wall, lamp on / off: shown %.3f, right %.3f\n", shown[1] / shown[0], wanted[1] / wanted[0]);
  EXPECT_NEAR(shown[1] / shown[0], wanted[1] / wanted[0], 0.05);
}

/// A source that places all lights anew says nothing of what changed: it is followed by half.
TEST_F(ListsTest, FollowsLightOfAnotherSet) {
  settings.gather.mode = GatherMode::Lists;
  settings.vpl.source = VplSource::Ir;
  Viewer gi(settings);
  stand(gi, 20);
  const double before = meanLuminance(gi.read(Buffer::Irradiance));
  room.scene.lights[0].intensity *= 0.9f;
  for (int i = 0; i < 4; ++i) {
    room.scene.lights[0].position.x += 1e-4f;
    gi.run(view(kLightsChanged));
  }
  EXPECT_NEAR(meanLuminance(gi.read(Buffer::Irradiance)) / before, 0.9, 0.02);
}

/// Where a view comes to rest lists go on, and the error does not rise when classes follow.
TEST_F(ListsTest, GoOnForSomeFramesAfterMotion) {
  settings.gather.mode = GatherMode::Lists;
  settings.history.frames = 64;
  const Image all = allLights();
  Viewer gi(settings);
  gi.run(room.scene.view());
  for (int i = 0; i < 8; ++i) {
    room.scene.camera.worldFromView[3].x += 0.004f * (i < 4 ? 1.0f : -1.0f); // and back
    gi.run(view(kCameraChanged));
  }
  const double moving = relativeRmse(gi.read(Buffer::Irradiance), all);
  int byLists = 0;
  double most = 0;
  for (int i = 0; i < 40; ++i) {
    const Image shown = nextFrame(gi, still());
    byLists += gi.stats().raysLists.closest > 0;
    most = std::max(most, relativeRmse(shown, all));
  }
  std::printf("moving %.4f, coming to rest at most %.4f, %d frames by lists\n", moving, most, byLists);
  EXPECT_EQ(byLists, 23);
  EXPECT_LT(most, 1.1 * moving);
}

/// Lights that are given, by lists that are chosen for what a camera sees.
class ListGatherTest : public GatherTest {
 protected:
  ListGatherTest() { settings.gather.near = 0; }

  /// Mean over frames, of what every class of pixels gathers once in sixteen.
  Image byLists(const GBuffer& gbuffer, std::span<const VirtualLight> lights, uint32_t frames, Buffer buffer) {
    const VirtualLights given{.packed = lightBuffer.run(lights), .slots = lights};
    const World world = placed->world();
    Patches none([] { return PatchPyramid(); });
    const EffectPlan plan;
    const Frame frame{{.world = world, .plan = plan, .settings = settings}, gbuffer, none};
    const auto gather = makeGather(axesOf(settings), passes);
    Image mean(gbuffer.width, gbuffer.height);
    for (uint32_t sample = 0; sample < frames; ++sample) {
      chosen = pass.run(
          {.view = world.view, .rays = world.rays, .lights = lights, .gather = settings.gather, .sample = sample},
          rays);
      const SurfaceLighting raw =
          gather->run({.frame = frame, .lights = {given}, .lists = &chosen, .sample = sample}, stats);
      const Image one = read(buffer, gbuffer, {}, filterPass.run({gbuffer, raw, {.on = false}}));
      for (size_t i = 0; i < mean.pixels.size(); ++i) mean.pixels[i] += one.pixels[i] / float(frames);
    }
    return mean;
  }
  Image byAll(const GBuffer& gbuffer, std::span<const VirtualLight> lights, Buffer buffer) {
    Settings all = settings;
    all.gather.mode = GatherMode::Full;
    return read(buffer, gbuffer, {}, gathered(gbuffer, lights, all));
  }

  Settings settings;
  ListPass pass;
  LightLists chosen; // for the last frame
  uint64_t rays = 0;
};

/// The colour of lights says which chunk of 2048 they are of.
TEST_F(ListGatherTest, ListsOfSeveralChunksMeanEveryLight) {
  Floor floor;
  floor.scene.size(48, 36);
  const GBuffer gbuffer = surfaces(floor.scene);
  std::vector<VirtualLight> lights;
  for (uint32_t i = 0; i < 5000; ++i) {
    const vec3 u = Rng(1, Stream::Test, i).next3();
    vec3 radiance(0);
    radiance[int(i / kLightsPerChunk)] = 1;
    lights.push_back(lightAt({6 * u.x - 3, 0.5f + u.y, 5 * u.z - 2.5f}, {0, -1, 0}, radiance, 0.01f));
  }
  settings.gather.lights = 256;
  const Image all = byAll(gbuffer, lights, Buffer::Irradiance),
              lists = byLists(gbuffer, lights, 16, Buffer::Irradiance);
  const double error = relativeRmse(lists, all);
  std::printf("5000 lights, 16 frames by lists of 256: %.4f\n", error);
  EXPECT_LT(error, 0.01);
}

/// Each light reaches a few tiles only, so that a list of another tile than the pixel's has little of what it needs.
TEST_F(ListGatherTest, PixelsReadTheListOfTheirTile) {
  for (const auto& [width, height, tile] : {std::tuple(70, 50, 4), std::tuple(164, 110, 8)}) { // over 1024 tiles of 4
    Floor floor;
    floor.scene.size(width, height);
    const GBuffer gbuffer = surfaces(floor.scene);
    std::vector<VirtualLight> lights;
    for (int i = 0; i < 36 * 28; ++i)
      lights.push_back(lightAt({0.2f * float(i % 36) - 3.5f, 0.15f, 0.2f * float(i / 36) - 2.7f}, {0, -1, 0},
                               vec3(0.5f + float(i % 7), 1, 1), 0.001f));
    const Image all = byAll(gbuffer, lights, Buffer::Irradiance),
                lists = byLists(gbuffer, lights, 1, Buffer::Irradiance);
    EXPECT_EQ(chosen.tile, tile);
    EXPECT_EQ(chosen.tiles, glm::ivec2((width + tile - 1) / tile, (height + tile - 1) / tile));
    const double error = relativeRmse(lists, all);
    std::printf("%d × %d, tiles of %d: %.4f\n", width, height, chosen.tile, error);
    EXPECT_LT(error, 0.02) << width;
  }
}

TEST_F(ListGatherTest, LobesCountLightsAsOftenAsIrradianceDoes) {
  Floor floor(vec3(0.9f, 0.6f, 0.2f), 0.4f, 0.5f);
  floor.scene.camera = cameraAt(vec3(1, 2, 2.2f), vec3(0), 0.7f, 48, 36);
  const GBuffer gbuffer = surfaces(floor.scene, true);
  std::vector<VirtualLight> lights;
  for (uint32_t i = 0; i < 400; ++i) {
    const vec3 u = Rng(1, Stream::Test, i).next3();
    lights.push_back(lightAt({4 * u.x - 2, 0.7f + u.y, 4 * u.z - 3}, {0, -1, 0}, vec3(1, 2, 3), 0.02f));
  }
  settings.gather.glossy = true;
  settings.gather.lights = 64;
  const Image all = byAll(gbuffer, lights, Buffer::Indirect), lists = byLists(gbuffer, lights, 16, Buffer::Indirect),
              one = byLists(gbuffer, lights, 1, Buffer::Indirect);
  const double error = relativeRmse(lists, all);
  std::printf("glossy, 400 lights, 16 frames by lists of 64: %.4f, one %.4f\n", error, relativeRmse(one, all));
  EXPECT_LT(error, 0.02);
}

/// Lights above a floor and what its tiles are told of them, frame by frame.
class LightChangePassTest : public GlTest {
 protected:
  LightChangePassTest() {
    for (int i = 0; i < 64; ++i)
      slots.push_back(lightAt({float(i % 8) - 3.5f, 1, float(i / 8) - 3.5f}, {0, -1, 0}, vec3(1), 0.1f));
    table.tiles = {1, 1};
    table.places.resize(kListPlaces);
    for (SurfaceHit& p : table.places) p.t = 1, p.normal = {0, 1, 0};
  }
  /// r and g of the only tile.
  vec2 next(std::span<const Aabb> moved = {}, bool mapsWait = false, bool unknown = false) {
    lights.slots = slots;
    pass.observe({.lights = lights, .moved = moved, .mapsWait = mapsWait, .unknown = unknown});
    std::vector<vec2> texels(1);
    pass.run(table, 1).texture->read(std::span(texels), GL_RG, GL_FLOAT);
    return texels[0];
  }

  std::vector<VirtualLight> slots;
  VirtualLights lights;
  ListTable table;
  LightChangePass pass;
};

TEST_F(LightChangePassTest, ChangesFadeByHalf) {
  EXPECT_EQ(next().x, 1) << "the first frame";
  EXPECT_EQ(next().x, 0.5f);
  for (int i = 0; i < 20; ++i) next();
  for (VirtualLight& l : slots) l.radiance *= 0.75f;
  EXPECT_NEAR(next().x, 0.25f, 1e-4f);
  const vec2 after = next();
  EXPECT_NEAR(after.x, 0.125f, 1e-4f);
  EXPECT_EQ(after.y, 0) << "what was gained is of one frame";
  EXPECT_EQ(next({}, false, true).x, 1);
}

TEST_F(LightChangePassTest, LightsThatMovedAreOthers) {
  for (int i = 0; i < 20; ++i) next();
  for (uint32_t slot = 0; slot < 32; ++slot) lights.moved.push_back(slot), slots[slot].radiance *= 2.0f;
  const vec2 change = next();
  EXPECT_EQ(change.y, 0);
  EXPECT_GT(change.x, 0.3f);
}

TEST_F(LightChangePassTest, WhatMovedCountsForSomeFramesAndWhileMapsWait) {
  for (int i = 0; i < 20; ++i) next();
  const Aabb above{vec3(-0.3f, 0.1f, -0.3f), vec3(0.3f, 0.5f, 0.3f)};
  const float share = next({&above, 1}).x;
  EXPECT_GT(share, 0.2f);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(next().x, share);
  for (int i = 0; i < 30; ++i) EXPECT_EQ(next({}, true).x, share);
  for (int i = 0; i < 20; ++i) next();
  EXPECT_LT(next().x, 0.01f * share);
}

} // namespace lambent::test::lists_test
