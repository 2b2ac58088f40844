// Near light mixed over neighbours: nothing made, nothing lost, patterns evened out, edges kept.
#include "engine/core/rng.h"
#include "gi/near/near_mix.h"

#include "tests/support/test.h"

namespace lambent::test::near_mix_test {

constexpr int kWidth = 24, kHeight = 16;

bool casts(int x, int y) { return ((x + y) & 1) == 0; }

/// A floor with a wall behind its upper rows; pixels are 0.1 m apart. One colour of the chessboard casts.
struct Corner {
  std::vector<vec3> positions, normals;
  explicit Corner(int wallRows, float stretch = 1) {
    for (const auto [x, y] : Pixels(kWidth, kHeight)) {
      const bool wall = y < wallRows;
      const float along = 0.1f * float(x), up = 0.1f * float(wallRows - y);
      const vec3 at = wall ? vec3(along, up, 0) : vec3(along, 0, -up * stretch);
      positions.push_back(casts(x, y) ? at : vec3(std::numeric_limits<float>::infinity()));
      normals.push_back(casts(x, y) ? (wall ? vec3(0, 0, 1) : vec3(0, 1, 0)) : vec3(0));
    }
  }
  NeighbourSurfaces seen(float cell) const { return {positions, normals, kWidth, cell}; }
};

/// Outliers of a frame before which nothing was known.
void spread(std::vector<vec3>& light, const NeighbourSurfaces& seen) {
  spreadOutliers(light, std::vector<float>(light.size(), 0), seen);
}

glm::dvec3 sumOf(const std::vector<vec3>& light) {
  glm::dvec3 sum(0);
  for (const vec3& l : light) sum += l;
  return sum;
}

TEST(NearMix, LightIsMovedNeitherMadeNorLost) {
  for (const float cell : {0.1f, 0.3f, 1.0f, 3.0f})
    for (const float stretch : {1.0f, 7.0f}) {
      const Corner corner(6, stretch);
      Rng rng(1, Stream::NearLight, 0);
      std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(0));
      for (size_t i = 0; i < light.size(); ++i) // bright spots, so that edges between them matter
        if (glm::length(corner.normals[i]) > 0) light[i] = std::pow(rng.next(), 8.0f) * vec3(9, 3, 1);
      const std::vector<vec3> traced = light;
      for (const auto& [move, least] : {std::pair(&mixPatterns, 0.2f), std::pair(&spread, 0.4f)}) {
        light = traced;
        move(light, corner.seen(cell));
        EXPECT_LT(glm::length(sumOf(light) - sumOf(traced)), 1e-5 * glm::length(sumOf(traced)));
        EXPECT_EQ(light != traced, cell > least) << "cell " << cell;
      }
    }
}

TEST(NearMix, OutliersAreSpreadOverTheirSurface) {
  const Corner corner(6);
  std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(0));
  for (const auto [x, y] : Pixels(kWidth, kHeight))
    if (casts(x, y)) light[size_t(y) * kWidth + x] = vec3(1);
  light[9 * kWidth + 11] = vec3(8); // within what its neighbours allow
  const std::vector<vec3> even = light;
  spread(light, corner.seen(3));
  EXPECT_EQ(light, even);
  light[9 * kWidth + 11] = vec3(33);
  spread(light, corner.seen(3));
  for (const auto [x, y] :
       Pixels(kWidth, kHeight)) { // 25 pixels within 3; those of the wall's rows are not of its kind
    const bool near = casts(x, y) && std::abs(x - 11) <= 3 && std::abs(y - 9) <= 3;
    EXPECT_NEAR(light[size_t(y) * kWidth + x].x, casts(x, y) ? (near ? 2 : 1) + (x == 11 && y == 9 ? 7 : 0) : 0, 1e-5)
        << x << ", " << y;
  }
}

TEST(NearMix, WhatIsKnownToBeBrightStaysSo) {
  const Corner floor(0);
  std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(1));
  std::vector<float> known(light.size(), 0);
  light[9 * kWidth + 11] = vec3(39);
  known[9 * kWidth + 11] = 10;
  const std::vector<vec3> traced = light;
  spreadOutliers(light, known, floor.seen(3));
  EXPECT_EQ(light, traced);
  light[9 * kWidth + 11] = vec3(65); // 25 pixels share what is above 40
  spreadOutliers(light, known, floor.seen(3));
  EXPECT_NEAR(light[9 * kWidth + 11].x, 41, 1e-4);
}

TEST(NearMix, WhatIsNoNumberIsNotSpread) {
  const Corner floor(0);
  for (const float odd : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(1));
    light[9 * kWidth + 11] = vec3(odd);
    light[5 * kWidth + 11] = vec3(100);
    spread(light, floor.seen(3));
    int odds = 0;
    for (const vec3& l : light) odds += !std::isfinite(l.x);
    EXPECT_EQ(odds, 1);
  }
}

/// Planes one behind the other, and what is far off, get nothing.
TEST(NearMix, OutliersStayOnTheirPlaneAndNear) {
  Corner floor(0);
  for (const auto [x, y] : Pixels({12, 0}, {kWidth, kHeight})) floor.positions[size_t(y) * kWidth + x].y -= 0.15f;
  std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(0));
  light[9 * kWidth + 11] = vec3(100);
  spread(light, floor.seen(0.8f)); // 0.32 m far: the pixel 3 away, not that 3 and 3 away
  for (const auto [x, y] : Pixels({8, 6}, {15, 13})) {
    const int across = x - 11, up = y - 9;
    const bool far = across * across + up * up > 10, below = x >= 12;
    EXPECT_EQ(light[size_t(y) * kWidth + x].x > 0, casts(x, y) && !far && !below) << x << ", " << y;
  }
}

TEST(NearMix, OutliersStayOnTheirSideOfAnEdge) {
  const Corner corner(6);
  std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(0));
  light[6 * kWidth + 10] = vec3(1);
  spread(light, corner.seen(3));
  EXPECT_LT(light[6 * kWidth + 10].x, 0.1f);
  for (const auto [x, y] : Pixels({0, 0}, {kWidth, 6})) ASSERT_EQ(light[size_t(y) * kWidth + x], vec3(0));
}

TEST(NearMix, FourPatternsAreEvenedOutOnAPlane) {
  for (const float stretch : {1.0f, 3.0f}) { // rows far apart, as on a floor seen at a grazing angle
    const Corner floor(0, stretch);
    std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(0));
    for (uint32_t y = 0; y < kHeight; ++y)
      for (uint32_t x = 0; x < kWidth; ++x)
        if (casts(int(x), int(y)) && ((x + y) >> 1 & 1) && ((x + ~y) >> 1 & 1)) light[y * kWidth + x] = vec3(4);
    mixPatterns(light, floor.seen(1));
    for (const auto [x, y] : Pixels({2, 2}, {kWidth - 2, kHeight - 2}))
      ASSERT_NEAR(light[size_t(y) * kWidth + x].x, casts(x, y), 1e-5) << x << ", " << y;
  }
}

TEST(NearMix, AWallTakesNothingFromTheFloor) {
  const Corner corner(6);
  std::vector<vec3> light(size_t(kWidth) * kHeight, vec3(0));
  for (const auto [x, y] : Pixels({0, 6}, {kWidth, kHeight}))
    if (casts(x, y)) light[size_t(y) * kWidth + x] = vec3(1);
  const std::vector<vec3> traced = light;
  mixPatterns(light, corner.seen(3));
  EXPECT_EQ(light, traced);
}

} // namespace lambent::test::near_mix_test
