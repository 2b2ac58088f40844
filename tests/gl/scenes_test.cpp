// More scenes than one: beside each other in one context, and one where another was.
#include "frames.h"

namespace lambent::test::scenes_test {

/// The room with a lamp, and a block more where `more`.
struct LitRoom : Room {
  explicit LitRoom(bool more = false) {
    scene.lamp({0.3f, 0.6f, 0.4f}, vec3(2));
    if (!more) return;
    scene.box(vec3(0.3f, -1, 0), vec3(0.6f, -0.2f, 0.3f), scene.material({0.1f, 0.2f, 0.8f}), false);
    scene.size(40, 56);
  }
};

Settings small() {
  Settings s;
  s.smc.vpls = s.smc.points = 64;
  s.smc.warmup = 2;
  s.shadow.resolution = 16;
  s.shadow.maker = ShadowMaker::Rays;
  s.rsm.resolution = 32;
  s.lpv.cells = 8;
  s.lpv.steps = 4;
  s.cube.resolution = 16;
  s.image.exposure = 1;
  s.debug.timing = TimingMode::Finish;
  return s;
}

class ScenesTest : public GlTest {
 protected:
  /// The n-th frame of a world: its lamp moves.
  static Image frame(Viewer& gi, LitRoom& room, int n) {
    LightView& lamp = room.scene.lights.front();
    lamp.position.x = 0.3f - 0.1f * float(n);
    lamp.changed = n > 0;
    return nextFrame(gi, room.scene.view(n > 0 ? kLightsChanged : SceneChanges{}), Buffer::Beauty);
  }
};

TEST_F(ScenesTest, TwoInOneContextDrawWhatEachDrawsAlone) {
  constexpr int kFrames = 3;
  const std::pair<const char*, const char*> pairs[] = {
      {"smc", "multires-splat"}, {"lpv", "isr"}, {"ibrr", "smc"}, {"area-multires", "hisr"}};
  for (const auto& [first, second] : pairs) {
    Settings settings[2] = {small(), small()};
    applyTechnique(settings[0], first);
    applyTechnique(settings[1], second);
    LitRoom rooms[2] = {LitRoom(false), LitRoom(true)};
    std::vector<Image> alone[2];
    for (int s = 0; s < 2; ++s) {
      Viewer gi(settings[s], 1 + s);
      for (int n = 0; n < kFrames; ++n) alone[s].push_back(frame(gi, rooms[s], n));
    }
    Viewer frames[2] = {Viewer(settings[0], 1), Viewer(settings[1], 2)};
    for (int n = 0; n < kFrames; ++n)
      for (int s = 0; s < 2; ++s)
        EXPECT_TRUE(sameBits(frame(frames[s], rooms[s], n), alone[s][size_t(n)]))
            << first << " with " << second << ": frame " << n << " of " << (s ? second : first);
    for (int s = 0; s < 2; ++s)
      EXPECT_TRUE(sameBits(frames[s].read(Buffer::Beauty), alone[s].back())) << "what one drew is not the other's";
  }
}

/// Two views of one scene: two frames share its assets and nothing else.
TEST_F(ScenesTest, TwoViewsOfOneSceneDrawWhatEachDrawsAlone) {
  const LitRoom room;
  SceneView views[2] = {room.scene.view(), room.scene.view()};
  views[1].camera = cameraAt(vec3(-0.6f, 0.5f, 0.8f), vec3(0.2f, -0.6f, -0.5f), 1.1f, 40, 30);
  const auto run = [&](Viewer& gi, int v) { return nextFrame(gi, views[v], Buffer::Beauty); };
  Image alone[2];
  for (int v = 0; v < 2; ++v) {
    Viewer gi(small());
    run(gi, v), alone[v] = run(gi, v);
  }
  Viewer frames[2] = {Viewer(small()), Viewer(small())};
  for (int n = 0; n < 2; ++n)
    for (int v = 0; v < 2; ++v) {
      const Image image = run(frames[v], v);
      EXPECT_TRUE(n == 0 || sameBits(image, alone[v])) << v;
    }
  EXPECT_FALSE(sameBits(alone[0], alone[1]));
}

TEST_F(ScenesTest, OneWhereAnotherWasIsDrawn) {
  for (const char* technique : {"smc", "multires-gather", "lpv", "isr", "hisr", "ibrr"}) {
    Settings settings = small();
    applyTechnique(settings, technique);
    const LitRoom second(true);
    Viewer fresh(settings);
    const Image expected = nextFrame(fresh, second.scene.view(), Buffer::Beauty);
    Viewer gi(settings);
    std::optional<LitRoom> room(std::in_place, false);
    const SceneAssets* const place = &room->scene.assets;
    gi.run(room->scene.view());
    room.reset();
    room.emplace(true);
    ASSERT_EQ(&room->scene.assets, place);
    const Image image = nextFrame(gi, room->scene.view(), Buffer::Beauty);
    if (needsOf(settings).reflective())
      EXPECT_TRUE(sameBits(image, expected)) << technique;
    else // sampled with the numbers of another frame
      EXPECT_NEAR(meanLuminance(image), meanLuminance(expected), 0.1 * meanLuminance(expected)) << technique;
    EXPECT_TRUE(sameBits(gi.read(Buffer::Albedo), fresh.read(Buffer::Albedo))) << technique;
    EXPECT_TRUE(sameBits(gi.read(Buffer::Direct), fresh.read(Buffer::Direct))) << technique;
    const SurfaceHit hit = gi.rays().closest(Ray{vec3(0.45f, 0.9f, 0.15f), vec3(0, -1, 0)});
    EXPECT_NEAR(hit.t, 1.1f, 1e-4f) << technique << ": rays know the new block";
  }
}

/// Assigned in place, copied, and moved elsewhere: its meshes lie somewhere else then.
TEST_F(ScenesTest, OneThatIsAssignedCopiedOrMovedIsOpenedAgain) {
  LitRoom room(false), other(true);
  Viewer gi(small());
  gi.run(room.scene.view());
  room.scene.assets = other.scene.assets;
  room.scene.instances = other.scene.instances;
  gi.run(room.scene.view());
  EXPECT_NEAR(gi.rays().closest(Ray{vec3(0.45f, 0.9f, 0.15f), vec3(0, -1, 0)}).t, 1.1f, 1e-4f);
  const Image before = gi.read(Buffer::Albedo);

  SceneAssets blue = room.scene.assets; // a copy, then changed
  for (Material& material : blue.materials) material.baseColor = vec3(0, 0, 1);
  SceneView ofCopy = room.scene.view();
  ofCopy.assets = &blue;
  gi.run(ofCopy);
  EXPECT_EQ(gi.read(Buffer::Albedo).at(20, 20).x, 0);

  auto moved = std::make_unique<SceneAssets>(std::move(room.scene.assets));
  room.scene.assets = {};
  SceneView view = room.scene.view();
  view.assets = moved.get();
  gi.run(view);
  EXPECT_TRUE(sameBits(gi.read(Buffer::Albedo), before));
}

} // namespace lambent::test::scenes_test
