#include "engine/core/rng.h"
#include "gi/lighting/light_set.h"
#include "tests/support/test.h"

namespace lambent::test::sampling_test {

TEST(Rng, IsUniformAndStreamsDiffer) {
  std::vector<double> counts(64, 0), expected(64, 65536 / 64);
  Rng rng(1, Stream::Test, 7);
  for (int i = 0; i < 65536; ++i) counts[int(rng.next() * 64)] += 1;
  EXPECT_LT(chiSquareDeviate(counts, expected), kDeviateLimit);
  // Neighbouring counters, ids, frames, streams and seeds must give unrelated numbers: pair them up in a grid.
  const auto pairs = [&](auto first, auto second) {
    std::vector<double> grid(64, 0), even(64, 16384 / 64);
    for (uint32_t i = 0; i < 16384; ++i) grid[int(first(i) * 8) * 8 + int(second(i) * 8)] += 1;
    return chiSquareDeviate(grid, even);
  };
  const auto at = [](uint32_t seed, Stream s, uint32_t id, uint32_t frame) { return Rng(seed, s, id, frame).next(); };
  const Stream t = Stream::Test;
  EXPECT_LT(pairs([&](uint32_t i) { return at(1, t, i, 0); }, [&](uint32_t i) { return at(1, t, i + 1, 0); }),
            kDeviateLimit);
  EXPECT_LT(pairs([&](uint32_t i) { return at(1, t, i, 0); }, [&](uint32_t i) { return at(1, t, i, 1); }),
            kDeviateLimit);
  EXPECT_LT(pairs([&](uint32_t i) { return at(1, t, i, 0); }, [&](uint32_t i) { return at(2, t, i, 0); }),
            kDeviateLimit);
  EXPECT_LT(
      pairs([&](uint32_t i) { return at(1, t, 0, i); }, [&](uint32_t i) { return at(1, Stream::Resample, 0, i); }),
      kDeviateLimit);
}

/// Counts directions in cells of equal cosθ and φ around n against the density's integral over each cell.
double directionDeviate(const vec3& n, bool cosine) {
  constexpr int kRings = 10, kSectors = 12, kSamples = 120000;
  std::vector<double> counts(kRings * kSectors, 0), expected(kRings * kSectors);
  vec3 t = glm::normalize(glm::cross(n, std::abs(n.x) < 0.9f ? vec3(1, 0, 0) : vec3(0, 1, 0)));
  const vec3 b = glm::cross(n, t);
  Rng rng(3, Stream::Test, 1);
  for (int i = 0; i < kSamples; ++i) {
    const vec3 d = cosine ? sampleCosineHemisphere(n, rng.next2()) : sampleSphere(rng.next2());
    EXPECT_NEAR(glm::length(d), 1, 1e-5);
    const float z = glm::dot(d, n), phi = std::atan2(glm::dot(d, b), glm::dot(d, t)) + kPi;
    const float share = cosine ? z : 0.5f * (z + 1);
    counts[std::clamp(int(share * kRings), 0, kRings - 1) * kSectors +
           std::clamp(int(phi / (2 * kPi) * kSectors), 0, kSectors - 1)] += 1;
  }
  for (int r = 0; r < kRings; ++r)
    for (int s = 0; s < kSectors; ++s) {
      const double lo = double(r) / kRings, hi = double(r + 1) / kRings;
      expected[r * kSectors + s] = kSamples * (cosine ? hi * hi - lo * lo : hi - lo) / kSectors;
    }
  return chiSquareDeviate(counts, expected);
}

TEST(Sampling, CosineHemisphereFollowsItsDensity) {
  EXPECT_LT(directionDeviate(glm::normalize(vec3(1, 2, -3)), true), kDeviateLimit);
  EXPECT_LT(directionDeviate(vec3(0, 0, -1), true), kDeviateLimit);
  EXPECT_FLOAT_EQ(pdfCosineHemisphere(0.5f), 0.5f / kPi);
  EXPECT_EQ(pdfCosineHemisphere(-0.5f), 0);
}

TEST(Sampling, SphereIsUniform) { EXPECT_LT(directionDeviate(vec3(0, 1, 0), false), kDeviateLimit); }

TEST(Sampling, TriangleIsUniform) {
  // Split the triangle into n² congruent small ones by barycentric rows.
  constexpr int n = 6, kSamples = 72000;
  std::vector<double> counts(2 * n * n, 0), expected(2 * n * n, 0);
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      expected[2 * (i * n + j)] = kSamples / double(n * n);
      if (i + j + 1 < n) expected[2 * (i * n + j) + 1] = kSamples / double(n * n);
    }
  Rng rng(4, Stream::Test, 2);
  for (int k = 0; k < kSamples; ++k) {
    const vec2 u = sampleTriangle(rng.next2());
    ASSERT_GE(u.x, 0);
    ASSERT_GE(u.y, 0);
    ASSERT_LE(u.x + u.y, 1.00001f);
    const int i = std::min(int(u.x * n), n - 1), j = std::min(int(u.y * n), n - 1);
    const bool upper = (u.x * n - i) + (u.y * n - j) > 1;
    counts[2 * (i * n + j) + upper] += 1;
  }
  EXPECT_LT(chiSquareDeviate(counts, expected), kDeviateLimit);
}

TEST(Sampling, DistributionFollowsWeightsAndSkipsZeros) {
  const std::vector<float> weights{0, 1, 3, 0, 0.5f, 7, 0};
  const Distribution d(weights);
  std::vector<double> counts(weights.size(), 0), expected(weights.size());
  Rng rng(5, Stream::Test, 3);
  for (int i = 0; i < 50000; ++i) counts[d.sample(rng.next())] += 1;
  for (size_t i = 0; i < weights.size(); ++i) {
    expected[i] = 50000 * weights[i] / 11.5;
    EXPECT_NEAR(d.probability(uint32_t(i)), weights[i] / 11.5, 1e-6);
    if (weights[i] == 0) {
      EXPECT_EQ(counts[i], 0);
    }
  }
  std::vector<double> some, wanted;
  for (size_t i = 0; i < weights.size(); ++i)
    if (weights[i] > 0) some.push_back(counts[i]), wanted.push_back(expected[i]);
  EXPECT_LT(chiSquareDeviate(some, wanted), kDeviateLimit);
  EXPECT_EQ(d.sample(0), 1u);
  EXPECT_EQ(d.sample(0x1.fffffep-1f), 5u);
  EXPECT_EQ(d.sample(1), 5u);
  EXPECT_TRUE(Distribution(std::vector<float>{0, 0}).empty());
}

TEST(Sampling, AdditiveRecurrenceIsEvenInEveryPairOfCoordinates) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<int> counts(16, 0);
    for (uint32_t i = 0; i < 256; ++i) {
      const vec3 p = additiveRecurrence3(i, vec3(0.3f, 0.7f, 0.1f));
      const float a = p[axis], b = p[(axis + 1) % 3];
      ASSERT_TRUE(a >= 0 && a < 1);
      counts[int(a * 4) * 4 + int(b * 4)] += 1;
    }
    for (int c : counts) EXPECT_NEAR(c, 16, 5); // random points would stray by more than 8 somewhere
  }
}

TEST(Lights, EmitterSamplesFollowTheirDensity) {
  LightSet lights;
  std::vector<EmitterTriangle> triangles{makeEmitterTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, vec3(1)),
                                         makeEmitterTriangle({2, 0, 0}, {4, 0, 0}, {2, 2, 0}, vec3(3)),
                                         makeEmitterTriangle({5, 0, 0}, {6, 0, 0}, {5, 1, 0}, vec3(0))};
  for (uint32_t i = 0; i < 3; ++i) triangles[i].meshTriangle = i;
  addEmitter(lights, 0, 0, triangles, false);
  const Emitter& e = lights.emitters[0];
  EXPECT_NEAR(e.power, 0.5f * 1 + 2 * 3, 1e-5);
  double integral = 0; // ∫ dA of the emitting part by importance sampling = 2.5
  std::vector<double> counts(2, 0);
  Rng rng(6, Stream::Test, 4);
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    const vec2 u = rng.next2();
    const EmitterPoint p = sampleEmitter(lights, e, {u.x, u.y, rng.next()});
    integral += 1 / p.pdfArea / kSamples;
    counts[p.position.x > 1.5f] += 1;
    EXPECT_FLOAT_EQ(p.pdfArea, pdfEmitterArea(lights, e, p.position.x > 1.5f ? 1 : 0));
  }
  EXPECT_NEAR(integral, 2.5, 0.05);
  const std::vector<double> expected{kSamples * 0.5 / 6.5, kSamples * 6 / 6.5};
  EXPECT_LT(chiSquareDeviate(counts, expected), kDeviateLimit);
}

TEST(Lights, ChoiceFollowsItsProbabilities) {
  LightSet lights;
  lights.punctual.resize(3);
  lights.punctual[0].position = {0, 2, 0};
  lights.punctual[1].position = {0, -2, 0}; // behind the surface
  lights.punctual[2] = {0, LightType::Directional, vec3(0), {0, -1, 0}, vec3(0.1f)};
  addEmitter(lights, 0, 0, {makeEmitterTriangle({1, 1, 0}, {2, 1, 0}, {1, 1, 1}, vec3(1))}, false);
  const LightChoice choice(lights, vec3(0), vec3(0, 1, 0));
  std::vector<double> counts(4, 0), expected(4);
  Rng rng(7, Stream::Test, 5);
  for (int i = 0; i < 40000; ++i) counts[choice.sample(rng.next()).light] += 1;
  double sum = 0;
  for (uint32_t i = 0; i < 4; ++i) sum += choice.probability(i), expected[i] = 40000 * choice.probability(i);
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_EQ(counts[1], 0);
  EXPECT_LT(chiSquareDeviate(std::vector{counts[0], counts[2], counts[3]},
                             std::vector{expected[0], expected[2], expected[3]}),
            kDeviateLimit);
}

TEST(Lights, PatchesAddUpToTheEmittersPower) {
  LightSet lights;
  addEmitter(lights, 0, 0,
             {makeEmitterTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, vec3(1, 2, 3)),
              makeEmitterTriangle({1, 0, 0}, {1, 1, 0}, {0, 1, 0}, vec3(1, 2, 3))},
             true);
  addEmitter(lights, 1, 0, {makeEmitterTriangle({0, 0, 5}, {2, 0, 5}, {0, 2, 5}, vec3(0.1f))}, false);
  const std::vector<EmitterPatch> patches = emitterPatches(lights, 16);
  double power[2] = {0, 0};
  for (const EmitterPatch& p : patches) power[p.position.z > 1] += double(luminance(p.radiance)) * p.area;
  EXPECT_NEAR(power[0], 2 * double(luminance(vec3(1, 2, 3))), 1e-4); // both sides of a square metre
  EXPECT_NEAR(power[1], 0.1 * 2, 1e-5);
}

// A map for each of many thousand lamps took gigabytes.
TEST(Lights, ManyEmittersShareTheirPatches) {
  LightSet lights;
  Rng rng(3, Stream::Test, 6);
  double powers[2] = {0, 0};
  for (uint32_t i = 0; i < 5000; ++i) { // two halls of lamps, those of one three times as bright
    const bool far = i % 4 == 0;
    const vec3 at(rng.next() * 10 + (far ? 100 : 0), rng.next(), rng.next() * 10);
    const float radiance = (far ? 3 : 1) * (0.5f + rng.next());
    addEmitter(lights, i, 0, {makeEmitterTriangle(at, at + vec3(0, 0, 0.1f), at + vec3(0.1f, 0, 0), vec3(radiance))},
               false);
    powers[far] += double(lights.emitters.back().power);
  }
  const std::vector<EmitterPatch> patches = emitterPatches(lights, 16);
  EXPECT_EQ(patches.size(), kMostEmitterPatches);
  double shares[2] = {0, 0}, along[2] = {0, 0};
  for (const EmitterPatch& p : patches) {
    const double power = double(luminance(p.radiance)) * p.area;
    shares[p.position.x > 50] += power;
    along[p.position.x > 50] += power * (p.position.x > 50 ? p.position.x - 100 : p.position.x);
    EXPECT_FLOAT_EQ(p.normal.y, 1);
  }
  for (const int hall : {0, 1}) {
    EXPECT_NEAR(shares[hall] / powers[hall], 1, 2.0 / double(kMostEmitterPatches) + 1e-3);
    EXPECT_NEAR(along[hall] / shares[hall], 5, 0.5); // they stand all over their hall
  }
}

} // namespace lambent::test::sampling_test
