// Lights by lists against every light at every pixel, and where lists serve.
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

} // namespace lambent::test::lists_test
