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
  SurfaceHit other = placeOf(1, 6);
  other.normal = {0, 1, 0};
  EXPECT_GT(rates.at(other).rays, most) << "came into sight";
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

} // namespace lambent::test::near_memory_test
