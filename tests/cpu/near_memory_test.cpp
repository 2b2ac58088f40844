// Where a moving view casts near rays.
#include "gi/near/near_memory.h"
#include "tests/support/hand_scene.h"

namespace lambent::test::near_memory_test {

/// Pixels whose rays find near surfaces cast more of them, those of open floors fewer, those that come into sight most.
TEST(NearRates, FollowWhatWasFound) {
  CameraView camera = cameraAt(vec3(0, 0, 5), vec3(0), 1, 8, 8);
  NearMemory memory;
  memory.fit(camera);
  const auto placeOf = [&](int x, int y) {
    const CameraRay ray = cameraRay(camera, (float(x) + 0.5f) / 8, (float(y) + 0.5f) / 8);
    SurfaceHit hit;
    hit.position = ray.origin + ray.direction * (5 / -ray.direction.z);
    hit.normal = {0, 0, 1};
    hit.t = 5;
    return hit;
  };
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      memory.positions[size_t(8 * y + x)] = placeOf(x, y).position;
      memory.normals[size_t(8 * y + x)] = {0, 0, 1};
      memory.near[size_t(8 * y + x)] = x < 4 ? 1.0f : y < 4 ? 0.25f : 0.0f;
      memory.light[size_t(8 * y + x)] = float(x);
    }
  std::vector<SurfaceHit> seen;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) seen.push_back(placeOf(x, y));
  const auto meanOfRays = [&](const NearRates& rates) {
    double sum = 0;
    for (const SurfaceHit& h : seen) sum += double(rates.at(h).rays) / double(seen.size());
    return sum;
  };
  const NearRates rates(memory, seen, 2);
  const float most = rates.at(placeOf(1, 6)).rays;
  EXPECT_NEAR(meanOfRays(rates), 2, 0.01);
  EXPECT_NEAR(rates.at(placeOf(6, 1)).rays, most / 2, 1e-5f) << "the root of a quarter; row 0 is the top";
  EXPECT_FLOAT_EQ(rates.at(placeOf(6, 6)).rays, 0.5f) << "never none: an eighth of the most would be less";
  EXPECT_EQ(rates.at(placeOf(3, 6)).light, 3);
  SurfaceHit other = placeOf(1, 6);
  other.normal = {0, 1, 0};
  EXPECT_GT(rates.at(other).rays, most) << "came into sight";
  EXPECT_EQ(rates.at(other).light, 0) << "and nothing is known of it";
  other = placeOf(1, 6);
  other.position.z += 2;
  EXPECT_GT(rates.at(other).rays, most) << "came into sight";
  // After a cut all pixels are new, and alike.
  for (SurfaceHit& h : seen) h.position.z += 2;
  EXPECT_NEAR(meanOfRays(NearRates(memory, seen, 2)), 2, 0.01);
  memory.forget();
  EXPECT_NEAR(meanOfRays(NearRates(memory, seen, 4)), 4, 0.01);
  EXPECT_NEAR(meanOfRays(NearRates(memory, seen, 0.25f)), 0.25, 0.01);
}

TEST(NearMemory, KeepsAMeanOfLightAndNothingElse) {
  NearMemory memory;
  memory.fit(cameraAt(vec3(0, 0, 5), vec3(0), 1, 2, 1));
  NearExpected before{.rays = 2, .near = 0.5f, .worthRays = 8, .light = 0};
  for (int frame = 0; frame < 200; ++frame) {
    memory.keep(0, before, 2, 2, frame % 2 ? 6.0f : 2.0f);
    before.near = memory.near[0];
    before.light = memory.light[0];
  }
  EXPECT_NEAR(memory.light[0], 4, 0.2);
  EXPECT_NEAR(memory.near[0], 1, 1e-3) << "all brought light";
  memory.keep(0, before, 1, 0, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(memory.light[0], before.light) << "what is no number does not stay";
  memory.keep(1, {.rays = 1, .near = 0.5f, .worthRays = 1, .light = 0}, 3, 0, 16);
  EXPECT_FLOAT_EQ(memory.near[1], 0.125f);
  EXPECT_FLOAT_EQ(memory.light[1], 1) << "a sixteenth of the first";
}

} // namespace lambent::test::near_memory_test
