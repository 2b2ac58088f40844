// Rankings must not hold noise for a difference, nor a difference for noise.
#include "gi/measure/stability.h"
#include "gi/measure/statistics.h"

#include "tests/support/normal.h"
#include "tests/support/test.h"

namespace lambent::test::ranking_test {

TEST(Ranking, MeanOverSeedsAndItsError) {
  const double runs[] = {1, 2, 6};
  const UncertainValue mean = meanOver(runs);
  EXPECT_DOUBLE_EQ(mean.value, 3);
  EXPECT_NEAR(mean.error, std::sqrt(7.0 / 3), 1e-12); // variance (4 + 1 + 9)/2
  EXPECT_EQ(mean.degrees, 2);
  EXPECT_TRUE(std::isnan(meanOver(std::span(runs).first(1)).error));
}

TEST(Ranking, ErrorsHoldSeedsTruthAndWhatItsNoiseBrings) {
  // Halves 0.4 apart and equal ones: variance (0.2² + 0)/2 for both. The second gains 0.3 where the truth is halved.
  const std::vector<UncertainValue> e =
      estimatesOf(std::vector<StatisticRuns>{{{1.1, 0.9}, {1.2, 0.8}}, {{2, 2}, {2.3, 2.3}}});
  EXPECT_NEAR(e[0].value, 1, 1e-12);
  EXPECT_NEAR(e[0].error, std::sqrt(0.01 + 0.02), 1e-12);
  EXPECT_NEAR(e[1].error, std::sqrt(0.02 + 0.09), 1e-12);
  EXPECT_NEAR(e[0].degrees, 9, 1e-9); // the one of two seeds, of a third of the variance
  EXPECT_NEAR(estimatesOf(std::vector<StatisticRuns>{{{1.1, 0.9}, {}}})[0].error, 0.1, 1e-12); // an exact truth
}

TEST(Ranking, OfOneSeedNothingIsKnown) {
  const std::vector<UncertainValue> e =
      estimatesOf(std::vector<StatisticRuns>{{{0.1}, {0.1, 0.1}}, {{0.9}, {0.9, 0.9}}});
  EXPECT_EQ(compared(e[0], e[1]), Order::Unknown);
  const std::string text = rankingText(std::vector<Ranked>{{"smc", e[0]}, {"ir", e[1]}});
  EXPECT_EQ(text.rfind("not ranked", 0), 0u) << text;
}

TEST(Ranking, DifferencesCountBeyondTwoStandardErrorsAndMoreOfFewRuns) {
  const auto order = [](double difference, double degrees) {
    return compared({1, 0.03, degrees}, {1 + difference, 0.04, degrees}); // 0.05 together
  };
  EXPECT_EQ(order(0.09, INFINITY), Order::WithinNoise);
  EXPECT_EQ(order(0.11, INFINITY), Order::Less);
  EXPECT_EQ(order(-0.11, INFINITY), Order::Greater);
  EXPECT_EQ(order(0.11, 49), Order::Less);
  EXPECT_EQ(order(0.19, 1), Order::WithinNoise); // Student's t of 1.85 degrees: 4.6
  EXPECT_EQ(order(0.25, 1), Order::Less);
  EXPECT_EQ(compared({1, 0, 1}, {1, 0, 1}), Order::WithinNoise);
  EXPECT_EQ(compared({1, 0, 1}, {1.5, 0, 1}), Order::Less);
}

TEST(Ranking, TextSaysWhatIsNotKnown) {
  const std::vector<Ranked> all = ranked({{"tcas", {0.021, 0.002}}, {"smc", {0.010, 0.001}}, {"ir", {0.020, 0.002}}});
  EXPECT_EQ(rankingText(all), "smc < ir; ir ≈ tcas (within noise)");
  EXPECT_EQ(rankingText(std::span(all).first(1)), "");
}

/// Two techniques at a grid of pixels over a few frames, held to a truth of which two halves are known: what
/// `lambent stability` sees. `a` scatters about the truth from pixel to pixel, `b` is too dark everywhere.
struct Experiment {
  double ofA, ofB; // true |E|
  double ofTruth;  // standard error of a value of the whole truth, the same in all frames
  int pixels = 64, frames = 3, seeds = 3;
};
struct Outcome {
  Order known, seedsAlone; // a against b
};
Outcome outcome(const Experiment& x, uint32_t trial) {
  Rng random(trial, Stream::Test, 1);
  std::vector<uint32_t> pixels;
  PixelSeries halves[2], whole;
  for (PixelSeries* s : {&halves[0], &halves[1], &whole}) s->assign(size_t(x.frames), {});
  for (int p = 0; p < x.pixels; ++p) {
    pixels.push_back(uint32_t(p));
    const double first = std::sqrt(2) * x.ofTruth * normal(random), second = std::sqrt(2) * x.ofTruth * normal(random);
    for (int f = 0; f < x.frames; ++f) {
      halves[0][size_t(f)].push_back(float(0.5 + first));
      halves[1][size_t(f)].push_back(float(0.5 + second));
      whole[size_t(f)].push_back(float(0.5 + 0.5 * (first + second)));
    }
  }
  std::vector<StatisticRuns> techniques;
  for (bool b : {false, true}) {
    StatisticRuns& t = techniques.emplace_back();
    t.halves = {0, 0};
    for (int k = 0; k < x.seeds; ++k) {
      PixelSeries series = whole;
      const double mean = std::sqrt(2 / double(kPi)); // of |N(0, 1)|
      for (size_t p = 0; p < pixels.size(); ++p) {
        const double value = 0.5 + (b ? -x.ofB * (1 + 0.1 * normal(random)) : x.ofA / mean * normal(random));
        for (auto& frame : series) frame[p] = float(value);
      }
      t.seeds.push_back(stabilityErrors(series, whole, pixels).error);
      for (int h = 0; h < 2; ++h) t.halves[size_t(h)] += stabilityErrors(series, halves[h], pixels).error / x.seeds;
    }
  }
  const std::vector<UncertainValue> known = estimatesOf(techniques);
  return {compared(known[0], known[1]), compared(meanOver(techniques[0].seeds), meanOver(techniques[1].seeds))};
}

/// Trials of 200 in which a is said to be worse than b, with the truth's noise and without it.
struct Wrong {
  int known = 0, seedsAlone = 0, right = 0;
};
Wrong wrongOf(const Experiment& x) {
  Wrong wrong;
  for (uint32_t trial = 0; trial < 200; ++trial) {
    const Outcome o = outcome(x, trial);
    wrong.known += o.known == Order::Greater;
    wrong.seedsAlone += o.seedsAlone == Order::Greater;
    wrong.right += o.known == Order::Less;
  }
  return wrong;
}

TEST(Ranking, ATruthOfFewPathsMustNotTurnItAround) {
  // As of maze-small with 64 paths: what is darker throughout shares one error with all of the truth's noise, what
  // scatters adds to it, and at |E| near the truth's own error the better technique looks like the worse one.
  const Wrong wrong = wrongOf({.ofA = 0.0170, .ofB = 0.0180, .ofTruth = 0.02});
  EXPECT_GT(wrong.seedsAlone, 40); // ignoring it misleads
  EXPECT_LE(wrong.known, 10);
}

TEST(Ranking, AGoodTruthLetsDifferencesBeSeen) {
  const Wrong wrong = wrongOf({.ofA = 0.0140, .ofB = 0.0240, .ofTruth = 0.002, .seeds = 5});
  EXPECT_EQ(wrong.known, 0);
  EXPECT_GT(wrong.right, 180);
}

TEST(Ranking, EqualTechniquesAreRarelyRanked) {
  const Wrong wrong = wrongOf({.ofA = 0.0200, .ofB = 0.0200, .ofTruth = 0.004, .seeds = 4});
  EXPECT_LE(wrong.known + wrong.right, 20);
}

TEST(Statistics, ErrorOfAnExponentIsThatOfItsScatter) {
  const std::vector<double> x{256, 512, 1024, 2048, 4096};
  double squaresX = 0, meanX = std::log(1024);
  for (double v : x) squaresX += std::pow(std::log(v) - meanX, 2);
  constexpr double kScatter = 0.05, kExponent = 1.25;
  constexpr int kTrials = 4000;
  double variance = 0, errors = 0;
  Rng random(1, Stream::Test, 2);
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> y;
    for (double v : x) y.push_back(0.3 * std::pow(v, kExponent) * std::exp(kScatter * normal(random)));
    variance += std::pow(exponentOf(x, y) - kExponent, 2) / kTrials;
    errors += std::pow(exponentError(x, y), 2) / kTrials;
  }
  const double expected = kScatter * kScatter / squaresX;
  EXPECT_NEAR(variance, expected, 4 * expected * std::sqrt(2.0 / kTrials));
  EXPECT_NEAR(errors, expected, 4 * expected * std::sqrt(2.0 / 3 / kTrials)); // chi² of 3 degrees each
}

TEST(Statistics, ErrorOfAnExponentOfAnExactPowerIsNone) {
  const double x[] = {1, 2, 4, 8}, y[] = {3, 12, 48, 192};
  EXPECT_NEAR(exponentOf(x, y), 2, 1e-12);
  EXPECT_NEAR(exponentError(x, y), 0, 1e-7);
  EXPECT_TRUE(std::isnan(exponentError(std::span(x).first(2), std::span(y).first(2))));
}

} // namespace lambent::test::ranking_test
