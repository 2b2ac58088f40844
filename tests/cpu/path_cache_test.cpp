// The path cache must not be seen in results: a set that keeps its paths and one that traces them all in every frame go
// through the same random edits of lights, objects and camera, and stay equal bit by bit.
#include "gi/vpl/smc.h"
#include "tests/support/random_world.h"

#include <gtest/gtest.h>

namespace lambent {
namespace {

void expectEqual(const VplSet& a, const VplSet& b, int frame) {
  ASSERT_EQ(a.pool.size(), b.pool.size()) << "frame " << frame;
  for (size_t i = 0; i < a.pool.size(); ++i) {
    ASSERT_EQ(a.pool[i].id, b.pool[i].id) << "candidate " << i << ", frame " << frame;
    ASSERT_EQ(a.pool[i].samplerRadiance, b.pool[i].samplerRadiance) << "candidate " << i << ", frame " << frame;
  }
  ASSERT_EQ(a.slots.size(), b.slots.size());
  for (size_t i = 0; i < a.slots.size(); ++i) {
    const Vpl &x = a.slots[i], &y = b.slots[i];
    ASSERT_EQ(x.id, y.id) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.alive, y.alive) << "slot " << i << ", frame " << frame;
    if (!x.alive) continue;
    ASSERT_EQ(x.position, y.position) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.area, y.area) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.samplerRadiance, y.samplerRadiance) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.radiance, y.radiance) << "slot " << i << ", frame " << frame;
  }
}

TEST(PathCache, EqualsTracingAllPathsThroughRandomEdits) {
  test::RandomWorld world(1e-3f);
  SmcSettings kept;
  kept.vpls = 48;
  kept.points = 64;
  kept.candidateRays = 4;
  kept.paths = 4;
  kept.warmup = 4;
  SmcSettings anew = kept;
  anew.cache = false;
  VplSet a, b;
  uint64_t traced = 0, all = 0;
  constexpr int kFrames = test::kSanitized ? 500 : 3000;
  for (int frame = 0; frame < kFrames; ++frame) {
    const SceneView& view = world.step(frame % 4);
    const LightSet lights = collectLights(view);
    VplUpdateLog logA, logB;
    updateVpls(a, {view, world.rays(), lights, kept, 5}, logA);
    updateVpls(b, {view, world.rays(), lights, anew, 5}, logB);
    ASSERT_NO_FATAL_FAILURE(expectEqual(a, b, frame));
    traced += logA.paths.traced;
    all += logB.paths.traced;
  }
  RecordProperty("traced_share", std::to_string(double(traced) / double(all)));
  std::printf("%d frames: %.1f %% of the paths traced anew\n", kFrames, 100.0 * double(traced) / double(all));
  EXPECT_LT(traced, all / 2);
}

TEST(PathCache, LightsThatMoveTraceNoPath) {
  test::RandomWorld world;
  SmcSettings settings;
  settings.vpls = 64;
  settings.points = 128;
  settings.moves = 0;
  VplSet set;
  const LightSet lights = collectLights(world.step(0));
  SceneView view = world.step(0);
  VplUpdateLog log;
  view.changes.first = view.changes.camera = view.changes.lights = true;
  updateVpls(set, {view, world.rays(), lights, settings, 1}, log);
  view.changes = {false, false, true, false, false};
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

} // namespace
} // namespace lambent
