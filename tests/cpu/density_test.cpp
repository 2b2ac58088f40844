#include "engine/core/rng.h"
#include "gi/vpl/smc.h"
#include "tests/support/test.h"

namespace lambent::test::density_test {

std::vector<DensityPoint> randomPoints(int n, uint32_t seed) {
  Rng rng(seed, Stream::Test, 11);
  std::vector<DensityPoint> points;
  for (int i = 0; i < n; ++i) {
    const vec2 u = rng.next2();
    points.push_back({{u.x, rng.next(), u.y}, glm::normalize(vec3(rng.next() - 0.5f, rng.next() - 0.5f, 0.3f))});
  }
  return points;
}

TEST(Density, NearestNeighboursAgreeWithBruteForce) {
  for (const int k : {1, 2, 5}) {
    const auto points = randomPoints(500, 1), queries = randomPoints(200, 2);
    const auto self = representedAreas(points, points, true, k, DensityEstimator::Knn, 1e9f);
    const auto other = representedAreas(queries, points, false, k, DensityEstimator::Knn, 1e9f);
    const auto brute = [&](const vec3& q, size_t skip) {
      std::vector<float> d2;
      for (size_t j = 0; j < points.size(); ++j)
        if (j != skip) d2.push_back(glm::dot(points[j].position - q, points[j].position - q));
      std::nth_element(d2.begin(), d2.begin() + (k - 1), d2.end());
      return kPi * d2[k - 1] / float(k);
    };
    for (size_t i = 0; i < points.size(); ++i) EXPECT_FLOAT_EQ(self[i], brute(points[i].position, i));
    for (size_t i = 0; i < queries.size(); ++i) EXPECT_FLOAT_EQ(other[i], brute(queries[i].position, SIZE_MAX));
  }
}

TEST(Density, OfAUniformDistributionIsUnbiased) {
  // Points uniform over a sphere: no border. The areas must add up to 4π in the mean, for any k.
  for (const int k : {1, 4, 16}) {
    std::vector<double> totals;
    for (uint32_t seed = 0; seed < 40; ++seed) {
      Rng rng(seed, Stream::Test, 12);
      std::vector<DensityPoint> points(1000);
      for (auto& p : points) p.position = p.normal = sampleSphere(rng.next2());
      double total = 0;
      for (float a : representedAreas(points, points, true, k, DensityEstimator::KnnSide, 1e9f)) total += a;
      totals.push_back(total);
    }
    // 1000 points instead of 999 others: the finite-N mean is 4π·N/(N−1).
    EXPECT_TRUE(agrees(meanOf(totals), 4 * kPi * 1000.0 / 999.0, 0.02 * 4 * kPi)) << "k=" << k;
  }
}

TEST(Density, FollowsAKnownDistribution) {
  // Density 3:1 between the halves of a plane: mean areas 1:3.
  Rng rng(5, Stream::Test, 13);
  std::vector<DensityPoint> points;
  for (int i = 0; i < 8000; ++i) {
    const bool dense = i % 4 != 0;
    points.push_back({{(dense ? 0.0f : 1.0f) + rng.next(), 0, rng.next()}, {0, 1, 0}});
  }
  const auto areas = representedAreas(points, points, true, 1, DensityEstimator::Knn, 1e9f);
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (size_t i = 0; i < points.size(); ++i) {
    const float x = points[i].position.x, z = points[i].position.z;
    if (z < 0.05f || z > 0.95f || x < 0.05f || x > 1.95f || std::abs(x - 1) < 0.05f) continue; // away from borders
    sum[x > 1] += areas[i];
    ++count[x > 1];
  }
  EXPECT_NEAR((sum[1] / count[1]) / (sum[0] / count[0]), 3, 0.25);
  EXPECT_NEAR(sum[0] / count[0], 1.0 / 6000, 0.03 / 6000 * 3);
}

TEST(Density, CoincidentPointsGetNoArea) {
  const std::vector<DensityPoint> points(50, {{1, 2, 3}, {0, 1, 0}});
  for (float a : representedAreas(points, points, true, 1, DensityEstimator::KnnSide, 5)) EXPECT_EQ(a, 0);
}

TEST(Density, FewerNeighboursThanAskedFor) {
  const std::vector<DensityPoint> one{{{0, 0, 0}, {0, 1, 0}}};
  EXPECT_EQ(representedAreas(one, one, true, 1, DensityEstimator::KnnSide, 7)[0], 7); // alone: the limit
  const std::vector<DensityPoint> three{{{0, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 1, 0}}, {{2, 0, 0}, {0, 1, 0}}};
  // Two others, five wanted: π·r₂²/2.
  EXPECT_FLOAT_EQ(representedAreas(three, three, true, 5, DensityEstimator::Knn, 1e9f)[0], kPi * 4 / 2);
  EXPECT_TRUE(representedAreas({}, three, false, 1, DensityEstimator::Knn, 1).empty());
  EXPECT_EQ(representedAreas(three, {}, false, 1, DensityEstimator::Knn, 9)[0], 9);
}

TEST(Density, IsolatedPointStaysUnderTheLimit) {
  std::vector<DensityPoint> points{{{0, 0, 0}, {0, 1, 0}}, {{100, 0, 0}, {0, 1, 0}}};
  EXPECT_EQ(representedAreas(points, points, true, 1, DensityEstimator::Knn, 2.5f)[0], 2.5f);
}

TEST(Density, SidesOfAThinWallDoNotCountEachOther) {
  // A 10×10 grid on each side of a wall 1 mm thick, spacing 0.1: paper 1's estimate sees the other side at 1 mm.
  std::vector<DensityPoint> points;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < 100; ++i)
      points.push_back({{0.1f * float(i % 10), 0.1f * float(i / 10), side * 1e-3f}, {0, 0, side ? 1.0f : -1.0f}});
  const auto plain = representedAreas(points, points, true, 1, DensityEstimator::Knn, 1e9f);
  const auto sided = representedAreas(points, points, true, 1, DensityEstimator::KnnSide, 1e9f);
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(plain[i], kPi * 1e-6f, 1e-7f);
    EXPECT_NEAR(sided[i], kPi * 0.01f, 1e-4f);
  }
}

TEST(Density, NeighboursForRenderingFollowEquation8) {
  SmcSettings s;
  for (const auto& [n, k] : std::vector<std::pair<int, int>>{{1, 1}, {512, 4}, {2048, 8}, {8192, 16}, {32768, 32}}) {
    s.vpls = n;
    EXPECT_EQ(neighboursForRendering(s), k) << n;
  }
  s.neighbours = 7;
  EXPECT_EQ(neighboursForRendering(s), 7);
}

TEST(Resampling, PicksAreUniformInArea) {
  // Hits ten times as dense on the left half of a plane as on the right; picks must be even.
  std::vector<double> shares;
  for (uint32_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed, Stream::Test, 14);
    std::vector<CandidateHit> hits(11000);
    for (size_t i = 0; i < hits.size(); ++i) {
      hits[i].position = {(i % 11 == 0 ? 1.0f : 0.0f) + rng.next(), 0, rng.next()};
      hits[i].normal = {0, 1, 0};
    }
    const Resampled r = resampleUniformInArea(hits, 400, seed, 0);
    EXPECT_EQ(r.picks.size(), 400u);
    double right = 0;
    for (uint32_t p : r.picks) right += hits[p].position.x > 1;
    shares.push_back(right / double(r.picks.size()));
    std::vector<uint32_t> sorted = r.picks;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end()) << "picked twice";
  }
  const Mean m = meanOf(shares);
  // Without replacement the sparse side, 1000 hits with half the weight, is thinned by what was picked already:
  // 200 of 1000 against 200 of 10000, a bias of at most 0.05 towards the dense side.
  EXPECT_GT(m.mean, 0.45 - kDeviateLimit * m.error);
  EXPECT_LT(m.mean, 0.50 + kDeviateLimit * m.error);
}

TEST(Resampling, SurvivesCoincidentHitsAndSmallSets) {
  std::vector<CandidateHit> same(10);
  EXPECT_LE(resampleUniformInArea(same, 20, 1, 0).picks.size(), 10u);
  EXPECT_GE(resampleUniformInArea(same, 20, 1, 0).picks.size(), 1u);
  EXPECT_TRUE(resampleUniformInArea({}, 20, 1, 0).picks.empty());
  EXPECT_EQ(resampleUniformInArea(std::span(same).first(1), 5, 1, 0).picks.size(), 1u);
  EXPECT_TRUE(std::isfinite(resampleUniformInArea(std::span(same).first(1), 5, 1, 0).area)) << "limits all VPLs' areas";
}

} // namespace lambent::test::density_test
