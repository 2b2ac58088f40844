#include "gi/measure/picture_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lambent {
namespace {

TEST(PictureErrorTest, ADifferenceInOneChannelOfOnePixelCountsByItsShareOfAllValues) {
  Image truth(2, 2, vec3(2)), picture = truth;
  EXPECT_EQ(rmse(picture, truth), 0);
  EXPECT_EQ(rmseShare(picture, truth), 0);
  picture.at(1, 0).y += 6;
  EXPECT_DOUBLE_EQ(rmse(picture, truth), std::sqrt(36.0 / 12));
  EXPECT_DOUBLE_EQ(rmseShare(picture, truth), std::sqrt(3.0) / 2);
  EXPECT_DOUBLE_EQ(meanOf(picture), 2.5);
}

TEST(PictureErrorTest, BlackAgainstBlackIsNoErrorAndLightAgainstBlackIsInfinite) {
  const Image black(3, 1), grey(3, 1, vec3(0.5f));
  EXPECT_EQ(rmseShare(black, black), 0);
  EXPECT_EQ(rmseShare(grey, black), std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(rmseShare(black, grey), 1);
}

} // namespace
} // namespace lambent
