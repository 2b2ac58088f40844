#include "gi/measure/front.h"

#include "tests/support/test.h"

namespace lambent::test::front_test {

using Indices = std::vector<size_t>;

TEST(Front, LeavesOutWhatAnotherBeats) {
  const std::vector<CostError> points{{4, 1}, {1, 8}, {2, 5}, {2, 4}, {3, 4}, {8, 1}, {5, 0.5}};
  EXPECT_EQ(frontOf(points), (Indices{1, 3, 0, 6}));
  EXPECT_TRUE(frontOf({}).empty());
}

TEST(Front, APointIsOffItOnlyByMoreThanNoise) {
  std::vector<CostError> points{{1, 1}, {1.3, 1.3}};
  EXPECT_TRUE(offFront(points, 1));
  EXPECT_FALSE(offFront(points, 0));
  for (CostError& p : points) p.errorNoise = 0.12; // ln 1.3 = 0.26 is less than two of 0.17
  EXPECT_TRUE(offFront(points, 1)) << "cheaper, and no farther";
  for (CostError& p : points) p.costNoise = 0.12;
  EXPECT_FALSE(offFront(points, 1));
  EXPECT_FALSE(offFront(std::vector<CostError>{{1, 1}, {1.3, 0.9}}, 1)); // dearer, and nearer
  EXPECT_TRUE(offFront(std::vector<CostError>{{1, 1}, {3, 1}}, 1));      // three times the price for nothing
}

TEST(Ladder, IsAsLongAsItsRuleAllows) {
  // 1 → 4 → 16 are steps; 2 and 8 lie between, and from either the ladder would be shorter.
  const std::vector<CostError> points{{1, 1}, {1.4, 0.9}, {2, 0.8}, {4, 0.6}, {8, 0.5}, {16, 0.4}, {40, 0.35}};
  EXPECT_EQ(ladderOf(points), (Indices{0, 3, 5}));
  EXPECT_EQ(ladderOf(points, {1.5, 0.3}), (Indices{0}));
  EXPECT_EQ(ladderOf(points, {1, 1}), (Indices{0, 1, 2, 3, 4, 5, 6}));
}

TEST(Ladder, TakesTheCheapestOfItsClass) {
  const std::vector<CostError> points{{3, 0.7}, {1, 1}, {2, 0.74}, {2.5, 0.73}};
  EXPECT_EQ(ladderOf(points), (Indices{1, 2}));
}

TEST(Ladder, NeverStandsOnAPointThatAnotherBeats) {
  const std::vector<CostError> points{{1, 1}, {3, 1.1}, {6, 0.5}};
  EXPECT_EQ(ladderOf(points), (Indices{0, 2}));
}

TEST(Knob, BuysWhatIsMoreThanNoise) {
  const std::vector<CostError> paying{{1, 1, 0.02, 0.1}, {2, 0.8, 0.02, 0.1}, {4, 0.5, 0.02, 0.1}};
  EXPECT_TRUE(knobVerdict(paying).buys);
  EXPECT_TRUE(knobVerdict(paying).monotone);
  EXPECT_DOUBLE_EQ(knobVerdict(paying).dearer, 4);
  EXPECT_DOUBLE_EQ(knobVerdict(paying).nearer, 0.5);
  const std::vector<CostError> idle{{1, 1, 0.02, 0.1}, {2, 0.8, 0.02, 0.1}};
  EXPECT_FALSE(knobVerdict(idle).buys);
  EXPECT_TRUE(knobVerdict(idle).costs);
  EXPECT_FALSE(knobVerdict(std::vector<CostError>{{1, 1, 0.02}, {1.02, 0.5}}).costs);
  EXPECT_FALSE(knobVerdict(std::vector<CostError>{{1, 1}, {2, 0.5}, {4, 2}}).buys);
  const std::vector<CostError> saving{{2, 1, 0.02, 0.1}, {1, 0.5, 0.02, 0.1}};
  EXPECT_FALSE(knobVerdict(saving).monotone);
  EXPECT_TRUE(knobVerdict(std::vector<CostError>{{1.02, 1, 0.02}, {1, 0.5, 0.02}}).monotone);
}

TEST(OverScenes, NoSceneCountsMore) {
  const std::vector<CostError> references{{10, 0.1}, {1000, 5}};
  const std::vector<CostError> points{{20, 0.1, 0.03, 0.3}, {2000, 20, 0.04, 0.4}};
  const CostError all = overScenes(points, references);
  EXPECT_DOUBLE_EQ(all.cost, 2);
  EXPECT_DOUBLE_EQ(all.error, 2);
  EXPECT_DOUBLE_EQ(all.costNoise, 0.025);
  EXPECT_DOUBLE_EQ(all.errorNoise, 0.25);
}

} // namespace lambent::test::front_test
