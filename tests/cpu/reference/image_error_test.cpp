#include "engine/core/rng.h"
#include "gi/measure/image_error.h"
#include "gi/measure/statistics.h"

#include "tests/support/test.h"

namespace lambent::test::image_error_test {

TEST(ImageErrorTest, ADifferenceInOneChannelOfOnePixelCountsByItsShareOfAllValues) {
  Image truth(2, 2, vec3(2)), picture = truth;
  EXPECT_EQ(imageError(picture, truth).rmse, 0);
  EXPECT_EQ(imageError(picture, truth).rmseShare(), 0);
  picture.at(1, 0).y += 6;
  const ImageError e = imageError(picture, truth);
  EXPECT_DOUBLE_EQ(e.rmse, std::sqrt(36.0 / 12));
  EXPECT_DOUBLE_EQ(e.rmseShare(), std::sqrt(3.0) / 2);
  EXPECT_DOUBLE_EQ(e.relMse, 36 / 4.01 / 12);
  EXPECT_DOUBLE_EQ(e.bias, 0.25); // too bright is above 0
  EXPECT_DOUBLE_EQ(imageError(truth, picture).bias, -0.2);
  EXPECT_EQ(e.largest, 6);
  EXPECT_EQ(e.meanTruth, 2);
  EXPECT_EQ(e.pixels, 4u);
}

TEST(ImageErrorTest, BlackAgainstBlackIsNoErrorAndLightAgainstBlackIsInfinite) {
  const Image black(3, 1), grey(3, 1, vec3(0.5f));
  EXPECT_EQ(imageError(black, black).rmseShare(), 0);
  EXPECT_EQ(imageError(grey, black).rmseShare(), std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(imageError(black, grey).rmseShare(), 1);
  EXPECT_DOUBLE_EQ(imageError(black, grey).bias, -1);
}

TEST(ImageErrorTest, PixelsOutsideTheMaskAndThoseNotFiniteAreLeftOut) {
  Image truth(3, 1, vec3(1)), picture(3, 1, vec3(1.5f)), mask(3, 1, vec3(1));
  picture.at(0, 0) = vec3(std::nanf(""));
  picture.at(1, 0) = vec3(9);
  mask.at(1, 0) = vec3(0);
  const ImageError e = imageError(picture, truth, mask);
  EXPECT_EQ(e.pixels, 1u);
  EXPECT_EQ(e.notFinite, 1u);
  EXPECT_DOUBLE_EQ(e.rmse, 0.5);
  EXPECT_DOUBLE_EQ(e.bias, 0.5);
}

TEST(ImageErrorTest, StandardErrorsTellTheRelMseThatIsMet) {
  Rng rng(3, Stream::NearLight, 0);
  Image truth(200, 100), error(200, 100), noisy(200, 100);
  for (size_t i = 0; i < truth.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      truth.pixels[i][c] = 2 * rng.next();
      error.pixels[i][c] = 0.3f * rng.next();
      noisy.pixels[i][c] = truth.pixels[i][c] + error.pixels[i][c] * std::sqrt(3.0f) * (2 * rng.next() - 1);
    }
  const double expected = expectedRelMse(truth, error);
  EXPECT_NEAR(imageError(noisy, truth).relMse, expected, 0.03 * expected);
  error.pixels[0] = vec3(INFINITY); // of a single sample
  EXPECT_NEAR(expectedRelMse(truth, error), expected, 0.01 * expected);
  EXPECT_EQ(expectedRelMse({}, {}), 0);
}

TEST(Statistics, SpreadOfAFewValues) {
  EXPECT_EQ(spreadOf({}).count, 0u);
  const Spread s = spreadOf({5, 1, 4, 2});
  EXPECT_EQ(s.median, 4); // the upper of the two in the middle
  EXPECT_EQ(s.least, 1);
  EXPECT_EQ(s.quarter, 2);
  EXPECT_EQ(s.threeQuarters, 5);
  EXPECT_EQ(s.most, 5);
  EXPECT_EQ(s.count, 4u);
  EXPECT_EQ(spreadOf({3}).median, 3);
}

TEST(Statistics, ExponentOfAPower) {
  const double x[] = {512, 2048, 8192}, y[] = {3 / std::sqrt(512.), 3 / std::sqrt(2048.), 3 / std::sqrt(8192.)};
  EXPECT_NEAR(exponentOf(x, y), -0.5, 1e-12);
}

TEST(ImageError, BrightestPixelsAreLeftOut) {
  Image truth(10, 10, vec3(1)), picture(10, 10, vec3(0.9f));
  truth.at(3, 4) = vec3(50);
  picture.at(3, 4) = vec3(10);
  const Image most = allButBrightest(truth, 0.01);
  EXPECT_LT(imageError(picture, truth).bias, -0.3);
  EXPECT_NEAR(imageError(picture, truth, most).bias, -0.1, 1e-6);
  EXPECT_EQ(imageError(picture, truth, most).pixels, 99u);
}

TEST(ImageError, BlocksAreHeldToTheirOwnMean) {
  Image truth(25, 10, vec3(1)), picture = truth; // two whole blocks
  picture.at(0, 0) = vec3(5);                    // +4 % of its block
  EXPECT_EQ(blocksWithin(picture, truth, 10, 0.05), 1);
  EXPECT_EQ(blocksWithin(picture, truth, 10, 0.03), 0.5);
  picture.at(15, 5) = vec3(-5);
  EXPECT_EQ(blocksWithin(picture, truth, 10, 0.05), 0.5);
  picture.at(22, 5) = vec3(100); // beyond the last whole block
  EXPECT_EQ(blocksWithin(picture, truth, 10, 0.05), 0.5);
}

} // namespace lambent::test::image_error_test
