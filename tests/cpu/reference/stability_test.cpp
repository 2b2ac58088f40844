// Errors over time on series with known answers, and truth at tracked pixels.
#include "engine/core/rng.h"
#include "gi/measure/stability.h"
#include "gi/vpl/smc.h"
#include "tests/support/reference.h"

namespace lambent::test::stability_test {

TEST(Stability, ReinhardOfExposedLuminance) {
  EXPECT_FLOAT_EQ(toneMappedLuminance(vec3(0.5f), 2), 0.5f);
  EXPECT_EQ(toneMappedLuminance(vec3(0), 2), 0);
}

TEST(Stability, ErrorAndChangeOfAKnownSeries) {
  const PixelSeries truth{{0.5f, 0.1f}, {0.6f, 0.1f}, {0.6f, 0.1f}};
  const PixelSeries technique{{0.6f, 0.1f}, {0.6f, 0.3f}, {0.5f, 0.1f}}; // E: .1 0 | 0 .2 | -.1 0
  const uint32_t both[] = {0, 1}, second[] = {1};
  const StabilityErrors e = stabilityErrors(technique, truth, both);
  EXPECT_NEAR(e.error, 0.4 / 6, 1e-6);
  EXPECT_NEAR(e.bias, 0.2 / 6, 1e-6);
  EXPECT_NEAR(e.change, (0.1 + 0.2 + 0.1 + 0.2) / 4, 1e-6);
  EXPECT_EQ(e.count, 6u);
  EXPECT_NEAR(stabilityErrors(technique, truth, second).change, 0.2, 1e-6);
}

TEST(Stability, ErrorThatStaysIsNoChange) {
  PixelSeries truth, technique;
  for (int t = 0; t < 50; ++t) {
    truth.push_back({float(t) / 100});
    technique.push_back({float(t) / 100 + 0.125f});
  }
  const uint32_t pixel[] = {0};
  const StabilityErrors e = stabilityErrors(technique, truth, pixel);
  EXPECT_NEAR(e.error, 0.125, 1e-6);
  EXPECT_NEAR(e.change, 0, 1e-6);
}

TEST(Stability, PixelsWithoutSurfaceAreLeftOut) {
  const float none = std::nanf("");
  const PixelSeries truth{{0.5f}, {none}, {0.5f}, {0.5f}}, technique{{0.6f}, {none}, {0.9f}, {0.8f}};
  const uint32_t pixel[] = {0};
  const StabilityErrors e = stabilityErrors(technique, truth, pixel);
  EXPECT_EQ(e.count, 3u);
  EXPECT_NEAR(e.error, 0.8 / 3, 1e-6);
  EXPECT_NEAR(e.change, 0.1, 1e-6); // only from frame 2 to 3
}

TEST(Stability, LatencyOfAnExponentialApproach) {
  // 1 − r^(n+1) of the step is made n frames after it: 90 % at n = ⌈ln 0.1/ln r⌉ − 1.
  const size_t step = 5, frames = 205;
  const uint32_t pixel[] = {0};
  const size_t steps[] = {step};
  for (const auto& [r, expected] : std::vector<std::pair<double, double>>{{0.0, 0}, {0.5, 3}, {0.9, 21}}) {
    PixelSeries truth, technique;
    for (size_t t = 0; t < frames; ++t) {
      truth.push_back({t < step ? 0.1f : 0.6f});
      technique.push_back({t < step ? 0.2f : float(0.2 + 0.4 * (1 - std::pow(r, double(t - step + 1))))});
    }
    const Latency l = latency90(technique, truth, pixel, steps);
    EXPECT_EQ(l.median, expected) << r;
    EXPECT_EQ(l.count, 1u);
    EXPECT_NEAR(l.followed, 0.8, 1e-4); // 0.4 of 0.5
  }
}

TEST(Stability, LatencyOfAStepDownAndOfOneThatIsMissed) {
  PixelSeries truth, technique;
  for (size_t t = 0; t < 40; ++t) {
    truth.push_back({t < 10 || t >= 20 ? 0.6f : 0.1f, 0.5f});
    technique.push_back({t < 12 || t >= 20 ? 0.6f : 0.1f, float(t) / 40}); // two frames late, then at once
  }
  const uint32_t both[] = {0, 1};
  const size_t steps[] = {10, 20};
  const Latency l = latency90(technique, truth, both, steps);
  EXPECT_EQ(l.count, 2u); // the second pixel's truth does not change
  EXPECT_EQ(l.worstTenth, 2);
  const PixelSeries stuck(40, {0.6f, 0.5f});
  EXPECT_EQ(latency90(stuck, truth, both, steps).worstTenth, 20); // as long as there was
  EXPECT_EQ(latency90(stuck, truth, both, steps).followed, 0);
  EXPECT_EQ(latency90(technique, truth, both, {}).count, 0u);
}

/// A box of `size` with its corner at the object's origin, carried from one place to another.
InstanceView carried(const vec3& size, const mat4& before, const mat4& now) {
  InstanceView i;
  i.worldFromObjectBefore = before;
  i.worldFromObject = now;
  i.boundsWorldBefore = transformed({vec3(0), size}, before);
  i.boundsWorld = transformed({vec3(0), size}, now);
  i.moved = before != now;
  return i;
}

mat4 turned(float degrees) { return glm::mat4_cast(glm::angleAxis(glm::radians(degrees), vec3(0, 1, 0))); }

mat4 at(const vec3& place) {
  mat4 m(1);
  m[3] = vec4(place, 1);
  return m;
}

TEST(Jumped, ALeafThatTurnsWidely) {
  // 1 m × 2 m: its free edge moves by 2 sin(a/2), a quarter of the diagonal (0.56 to 0.61 m) at about 34 degrees.
  const vec3 leaf(1, 2, 0.05f);
  EXPECT_FALSE(jumped(carried(leaf, turned(0), turned(0)), {vec3(0), leaf}));
  EXPECT_FALSE(jumped(carried(leaf, turned(0), turned(2)), {vec3(0), leaf}));
  EXPECT_FALSE(jumped(carried(leaf, turned(20), turned(45)), {vec3(0), leaf}));
  EXPECT_TRUE(jumped(carried(leaf, turned(20), turned(60)), {vec3(0), leaf}));
  EXPECT_TRUE(jumped(carried(leaf, turned(75), turned(20)), {vec3(0), leaf}));
  EXPECT_TRUE(jumped(carried(leaf, turned(0), turned(180)), {vec3(0), leaf})); // its bounds hardly differ
}

TEST(Jumped, ASmallBoxCarriedFast) {
  const vec3 box(0.3f); // diagonal 0.52 m
  EXPECT_FALSE(jumped(carried(box, at({5, 1, 2}), at({5.12f, 1, 2})), {vec3(0), box}));
  EXPECT_TRUE(jumped(carried(box, at({5, 1, 2}), at({5.14f, 1, 2})), {vec3(0), box}));
  const vec3 large(3); // the same way is short for a larger one
  EXPECT_FALSE(jumped(carried(large, at({5, 1, 2}), at({5.14f, 1, 2})), {vec3(0), large}));
  const mat4 scaled = at({5, 1, 2}) * glm::mat4_cast(glm::angleAxis(0.1f, vec3(1, 0, 0))) * mat4(mat3(10));
  mat4 there = scaled; // in world space a metre, its object's space ten times smaller
  there[3].x += 0.8f;
  EXPECT_FALSE(jumped(carried(box, scaled, there), {vec3(0), box}));
}

TEST(Jumped, ALiftThatSteps) {
  const vec3 cabin(1.6f, 2.3f, 1.6f); // diagonal 3.2 m
  EXPECT_FALSE(jumped(carried(cabin, at({0, 0.15f, 0}), at({0, 0.15f + 2.2f / 30, 0})), {vec3(0), cabin}));
  EXPECT_TRUE(jumped(carried(cabin, at({0, 0.15f, 0}), at({0, 3.2f, 0})), {vec3(0), cabin}));
  EXPECT_TRUE(jumped(carried(cabin, at({0, 3.2f, 0}), at({0, 0.15f, 0})), {vec3(0), cabin}));
  InstanceView still = carried(cabin, at({0, 0, 0}), at({0, 3, 0}));
  still.moved = false; // as for an instance seen for the first time
  EXPECT_FALSE(jumped(still, {vec3(0), cabin}));
  EXPECT_FALSE(jumped(carried(cabin, at({0, 0, 0}), at({0, 3, 0})), Aabb{})); // a mesh without triangles
}

TEST(TrackedPixels, AgreeWithThePictureAtPixelCentres) {
  ReferenceBox box;
  box.scene.size(16, 8);
  const TracedScene traced(box.scene);
  const auto& [view, rays, lights] = traced;
  constexpr uint32_t kSamples = 400;
  RayCounts counts;
  ReferenceSums picture(16, 8);
  addSamples(picture, {rays, lights, view.camera, 3, 0, 1}, kSamples, counts);
  std::vector<vec2> centres;
  for (int i = 0; i < 16 * 8; ++i) centres.push_back({(float(i % 16) + 0.5f) / 16, (float(i / 16) + 0.5f) / 8});
  const std::vector<SurfaceHit> surfaces = surfacesAt(rays, view.camera, centres);
  const auto sums = sampleSurfaces(surfaces, {rays, lights, view.camera, 3, 0, 2}, kSamples, counts); // another seed
  double statistic = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    const auto moments = [&](const PixelSums& p) {
      const double mean = p.indirect.x / kSamples;
      return std::pair(mean, (p.indirectSquares.x / kSamples - mean * mean) / (kSamples - 1));
    };
    const auto [a, va] = moments(sums[i]);
    const auto [b, vb] = moments(picture.pixels[i]);
    EXPECT_TRUE(surfaces[i].valid());
    EXPECT_GT(a, 0);
    statistic += (a - b) * (a - b) / (va + vb);
  }
  // Squares of 128 normal deviates; their variances are estimates, which widens the tail a little.
  EXPECT_LT(chiSquareDeviate(statistic, double(sums.size())), 4.5);
  EXPECT_GT(chiSquareDeviate(statistic, double(sums.size())), -4.5);
}

} // namespace lambent::test::stability_test
