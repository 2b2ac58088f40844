// The path cache must not be seen in results: a set that keeps its paths and one that traces them all in every frame go
// through the same random edits of lights, objects and camera, and stay equal bit by bit.
#include "gi/vpl/smc.h"
#include "tests/support/random_world.h"

namespace lambent::test::path_cache_test {

void expectEqual(const VplSet& a, const VplSet& b, int frame) {
  SCOPED_TRACE(frame);
  ASSERT_EQ(a.pool.size(), b.pool.size());
  for (size_t i = 0; i < a.pool.size(); ++i) {
    ASSERT_EQ(a.pool[i].id, b.pool[i].id) << i;
    ASSERT_EQ(a.pool[i].samplerRadiance, b.pool[i].samplerRadiance) << i;
  }
  ASSERT_EQ(a.slots.size(), b.slots.size());
  for (size_t i = 0; i < a.slots.size(); ++i) {
    const Vpl &x = a.slots[i], &y = b.slots[i];
    ASSERT_EQ(x.id, y.id) << "slot " << i;
    ASSERT_EQ(x.alive, y.alive);
    if (!x.alive) continue;
    ASSERT_EQ(x.position, y.position);
    ASSERT_EQ(x.area, y.area);
    ASSERT_EQ(x.samplerRadiance, y.samplerRadiance);
    ASSERT_EQ(x.radiance, y.radiance);
  }
}

/// Both kinds of set through `frames` frames; `viewOf(frame)` gives the next view. Share of the paths traced anew.
template <class ViewOf> double tracedShare(const RandomWorld& world, int frames, ViewOf&& viewOf) {
  const SmcSettings kept{.vpls = 48, .candidateRays = 4, .paths = 4, .points = 64, .warmup = 4};
  SmcSettings anew = kept;
  anew.cache = false;
  VplSet a, b;
  uint64_t traced = 0, all = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const SceneView& view = viewOf(frame);
    const LightSet lights = collectLights(view);
    VplUpdateLog logA, logB;
    updateVpls(a, {view, world.rays(), lights, kept, 5}, logA);
    updateVpls(b, {view, world.rays(), lights, anew, 5}, logB);
    expectEqual(a, b, frame);
    if (testing::Test::HasFatalFailure()) break;
    traced += logA.paths.traced;
    all += logB.paths.traced;
  }
  std::printf("%d frames: %.1f %% of the paths traced anew\n", frames, 100.0 * double(traced) / double(all));
  return double(traced) / double(all);
}

TEST(PathCache, EqualsTracingAllPathsThroughRandomEdits) {
  RandomWorld world(1e-3f);
  const int frames = kSanitized ? 200 : isLong() ? 3000 : 1000;
  const double share = tracedShare(world, frames, [&](int frame) -> const SceneView& { return world.step(frame % 4); });
  RecordProperty("traced_share", std::to_string(share));
  EXPECT_LT(share, 0.5);
}

// Sixty lamps more, of which one moves in every other frame: lights are chosen by a tree, which is then another.
TEST(PathCache, EqualsTracingAllPathsUnderManyLamps) {
  RandomWorld world(1e-3f);
  Rng rng(3, Stream::Test, 0);
  std::vector<LightView> lamps(60);
  for (LightView& l : lamps) {
    l.position = vec3(-2.8f, 0.2f, -2.8f) + rng.next3() * vec3(5.6f, 2.6f, 5.6f);
    l.intensity = vec3(0.3f);
  }
  std::vector<LightView> lights; // of the frame
  SceneView view;
  const int frames = kSanitized ? 60 : isLong() ? 300 : 150;
  const double share = tracedShare(world, frames, [&](int frame) -> const SceneView& {
    view = world.step(frame % 3);
    if (frame % 2 == 0) {
      lamps[rng.below(uint32_t(lamps.size()))].position += 0.1f * (rng.next3() - 0.5f);
      view.changes.lights = true;
    }
    lights.assign(view.lights.begin(), view.lights.end());
    lights.insert(lights.end(), lamps.begin(), lamps.end());
    view.lights = lights;
    return view;
  });
  EXPECT_LT(share, 0.5);
}

TEST(PathCache, LightsThatMoveTraceNoPath) {
  RandomWorld world;
  const SmcSettings settings{.vpls = 64, .moves = 0, .points = 128};
  VplSet set;
  const LightSet lights = collectLights(world.step(0));
  SceneView view = world.step(0);
  VplUpdateLog log;
  view.changes.first = view.changes.camera = view.changes.lights = true;
  updateVpls(set, {view, world.rays(), lights, settings, 1}, log);
  view.changes = kLightsChanged;
  LightSet moved = lights;
  moved.punctual[0].position += vec3(0.3f, 0, 0.1f);
  log = {};
  updateVpls(set, {view, world.rays(), moved, settings, 1}, log);
  // Only the candidates drawn in this frame, twice as many as in a frame without a change.
  EXPECT_EQ(log.paths.retraced, 0u);
  EXPECT_EQ(log.paths.traced, uint64_t(2 * settings.vpls / settings.poolFrames) * (settings.paths / 2));
  EXPECT_EQ(log.relit, 64u);
  EXPECT_GT(log.radiosity.occlusion, 1000u);
}

} // namespace lambent::test::path_cache_test
