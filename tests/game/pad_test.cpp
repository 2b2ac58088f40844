#include "game/rules/pad.h"

#include "tests/support/test.h"

namespace lambent::test::pad_test {

TEST(Pad, AStickAtRestMovesNothingAndAtTheRimAll) {
  EXPECT_EQ(stick({0.1f, -0.12f}), vec2(0));
  EXPECT_NEAR(glm::length(stick({0.71f, 0.71f})), 1, 1e-3f);
  EXPECT_NEAR(stick({0, -1}).y, -1, 1e-6f);
  EXPECT_LT(glm::length(stick({0.4f, 0})), 0.1f) << "finer near the middle";
  EXPECT_GT(stick({0.4f, 0}).x, 0);
}

TEST(Pad, WalksWithTheLeftStickAndLooksWithTheRight) {
  MoveInput move;
  PadState pad;
  pad.left = {0, -1};  // up: ahead
  pad.right = {1, -1}; // right and up
  PadButtons down{};
  down[size_t(PadButton::Jump)] = true;
  addPad(move, pad, down, 0.1f);
  EXPECT_NEAR(move.direction.z, -1, 1e-6f);
  EXPECT_GT(move.look.x, 0);
  EXPECT_GT(move.look.y, 0);
  EXPECT_TRUE(move.jump);
  EXPECT_FALSE(move.fast);
  MoveInput twice = move;
  addPad(twice, pad, down, 0.1f);
  EXPECT_NEAR(twice.direction.z, -1, 1e-6f) << "keys and pad together are no faster";
}

} // namespace lambent::test::pad_test
