// When a set of VPLs in a still world is taken to have settled: not too early, and at all.
#include "gi/vpl/smc.h"
#include "tests/support/hand_scene.h"

namespace lambent::test::settling_test {

/// A room with a block and a narrow spot on one wall: light that a new set does not find at once.
struct LitRoom {
  HandScene scene;
  std::optional<TracedScene> traced;
  std::vector<SurfaceHit> seen;

  LitRoom() {
    const uint32_t grey = scene.material(vec3(0.6f));
    scene.box({-2, 0, -2}, {2, 2.5f, 2}, grey, true);
    scene.box({-0.5f, 0, -0.8f}, {0.4f, 1.2f, 0}, grey, false);
    LightView& spot = scene.lamp({0.5f, 2.3f, 1}, vec3(20));
    spot.type = LightType::Spot;
    spot.direction = glm::normalize(vec3(-1, -0.9f, -0.4f));
    spot.innerConeCos = 0.97f;
    spot.outerConeCos = 0.93f;
    scene.camera.worldFromView[3] = vec4(0.8f, 1.2f, 1.9f, 1);
    scene.camera.fovY = 1.1f;
    traced.emplace(scene);
    std::vector<vec2> points;
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 16; ++j) points.push_back((vec2(j, i) + 0.5f) / vec2(16, 12));
    seen = surfacesAt(traced->rays, scene.camera, points);
  }

  void update(VplSet& set, const SmcSettings& settings, uint32_t seed) {
    SceneView now = traced->view;
    if (set.frame > 0) now.changes = kStill;
    VplUpdateLog log;
    updateVpls(set, {now, traced->rays, traced->lights, settings, seed}, log);
  }

  std::vector<vec3> irradiance(const VplSet& set) {
    RayCounts counts;
    return irradianceByRays(traced->rays, seen, lightsOf(set), {}, counts);
  }
};

double relativeError(const std::vector<vec3>& a, const std::vector<vec3>& truth) {
  double difference = 0, whole = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const vec3 d = a[i] - truth[i];
    difference += double(glm::dot(d, d));
    whole += double(glm::dot(truth[i], truth[i]));
  }
  return std::sqrt(difference / whole);
}

TEST(Settling, WaitsForTheFallToEnd) {
  Settling s;
  // A number that falls by 3 % per window, with noise, is no rest: down to where it stays.
  double level = 500;
  int settledAt = -1;
  for (int frame = 0; frame < 6000 && settledAt < 0; ++frame) {
    if (frame % 32 == 0 && frame < 3200) level *= 0.97;
    const double noise = 0.05 * level * std::sin(1.7 * frame);
    s.observe(uint32_t(level + noise), 0, 2048, 16);
    if (s.settled()) settledAt = frame;
  }
  EXPECT_GE(settledAt, 3200);
  EXPECT_LT(settledAt, 3200 + 10 * 32);
}

TEST(Settling, SlowReplacementIsWatchedLonger) {
  // One replacement per frame turns a quarter of 2048 over in 512 frames.
  Settling s;
  int frame = 0;
  for (; frame < 10000 && !s.settled(); ++frame) s.observe(100, 0, 2048, 1);
  EXPECT_EQ(frame, 512 * (1 + int(Settling::kPatience)));
}

TEST(Settling, NotWhileAVplIsUnverified) {
  Settling s;
  for (int frame = 0; frame < 1000; ++frame) s.observe(0, 1, 64, 16);
  EXPECT_FALSE(s.settled());
  s.observe(0, 0, 64, 16);
  EXPECT_TRUE(s.settled());
  s.restart();
  EXPECT_FALSE(s.settled());
  s.observe(0, 0, 64, 16);
  EXPECT_FALSE(s.settled()) << "what it waited before is forgotten";
  Settling fixed; // nothing is replaced
  fixed.observe(0, 1, 64, 0);
  EXPECT_FALSE(fixed.settled());
  fixed.observe(0, 0, 64, 0);
  EXPECT_TRUE(fixed.settled());
}

/// Most sets stay as they are once they have settled; of some a better or a worse one comes about, mostly within two
/// hundred frames.
TEST(Settling, SettledSetsAreNoWorseThanLater) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  LitRoom room;
  const SmcSettings many{.vpls = 2048, .paths = 64, .warmup = 20},
      few{.vpls = 64, .moves = 2, .points = 128, .warmup = 0};
  VplSet best;
  room.update(best, many, 77);
  const std::vector<vec3> truth = room.irradiance(best);

  std::vector<double> atFirst, later, differences;
  int frames = 0;
  for (uint32_t seed = 1; seed <= 64; ++seed) {
    VplSet set;
    room.update(set, few, seed);
    atFirst.push_back(relativeError(room.irradiance(set), truth));
    int frame = 1;
    for (; frame < 1000 && !set.settling.settled(); ++frame) room.update(set, few, seed);
    ASSERT_LT(frame, 1000);
    const double settled = relativeError(room.irradiance(set), truth);
    for (int i = 0; i < 250; ++i) room.update(set, few, seed);
    later.push_back(relativeError(room.irradiance(set), truth));
    differences.push_back(settled - later.back());
    frames += frame;
  }
  const double whole = meanOf(later).mean, first = meanOf(atFirst).mean;
  const Mean difference = meanOf(differences);
  std::printf(
      "settled after %d frames on average; relative RMSE at first %.3f, 250 frames later %.3f, settled %+.4f +- %.4f\n",
      frames / int(later.size()), first, whole, difference.mean, difference.error);
  EXPECT_GT(first, 1.2 * whole) << "else this cannot fail";
  EXPECT_LT(difference.error, 0.012 * whole) << "too noisy to tell";
  EXPECT_LT(difference.mean, 0.03 * whole); // two and a half of these: 99.4 %, one-sided
}

} // namespace lambent::test::settling_test
