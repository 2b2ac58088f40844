// Known errors and known noise of the truth: what is left without the noise must be the errors.
#include "gi/measure/truth_noise.h"

#include "tests/support/normal.h"
#include "tests/support/test.h"

#include <numeric>

namespace lambent::test::truth_noise_test {

constexpr size_t kFrames = 60, kPixels = 64;
constexpr uint32_t kSeeds = 60;
constexpr double kSize = 0.01; // deviation of errors

enum class Errors { Normal, Spread, Rare, Constant };

/// Errors whose deviation over all is kSize, and of the truth noise with `noise`, nine tenths of it (of variance) the
/// same in all frames of a pixel.
struct Recorded {
  PixelSeries technique, truth, halfA, halfB, exact;
};
Recorded recorded(Errors kind, double noise, uint32_t seed) {
  Rng random(seed, Stream::Test, uint32_t(kind), uint32_t(1e6 * noise));
  std::vector<vec2> lasting;
  for (size_t p = 0; p < kPixels; ++p) lasting.push_back({normal(random), normal(random)});
  const auto error = [&](size_t p) {
    switch (kind) {
    case Errors::Normal:
      return normal(random);
    case Errors::Spread:
      return std::sqrt(2.0) * double(p) / kPixels * 1.2 * normal(random);
    case Errors::Rare:
      return random.next() < 0.1f ? std::sqrt(10.0) * normal(random) : 0;
    case Errors::Constant:
      return random.next() < 0.5f ? 1.0 : -1.0;
    }
    return 0.0;
  };
  Recorded r;
  for (size_t t = 0; t < kFrames; ++t) {
    for (PixelSeries* s : {&r.technique, &r.truth, &r.halfA, &r.halfB, &r.exact}) s->emplace_back();
    for (size_t p = 0; p < kPixels; ++p) {
      const double exact = 0.3 + 0.2 * double(t) / kFrames;
      const auto half = [&](float ofPixel) {
        return exact + std::sqrt(2.0) * noise * (std::sqrt(0.9) * ofPixel + std::sqrt(0.1) * normal(random));
      };
      const double a = half(lasting[p].x), b = half(lasting[p].y);
      r.exact[t].push_back(float(exact));
      r.technique[t].push_back(float(exact + kSize * error(p)));
      r.halfA[t].push_back(float(a));
      r.halfB[t].push_back(float(b));
      r.truth[t].push_back(float((a + b) / 2));
    }
  }
  return r;
}

std::vector<uint32_t> allPixels() {
  std::vector<uint32_t> all(kPixels);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

NoisyErrors errorsOf(const Recorded& r, ErrorKind kind) {
  NoisyErrors errors;
  addNoisyErrors(errors, kind, r.technique, r.truth, r.halfA, r.halfB, allPixels());
  return errors;
}

double exactOf(const Recorded& r, ErrorKind kind) {
  const StabilityErrors e = stabilityErrors(r.technique, r.exact, allPixels());
  return kind == ErrorKind::Error ? e.error : e.change;
}

/// Over the seeds.
struct Outcomes {
  std::vector<double> off, raw; // how far |E| or |E'| is from what an exact truth gives: without noise, as it is
  std::vector<double> errors;   // stated
  double squares = 0;           // of off over its stated error

  void add(const UncertainValue& left, double asItIs, double exact) {
    off.push_back(left.value - exact);
    raw.push_back(asItIs - exact);
    errors.push_back(left.error);
    squares += off.back() * off.back() / (left.error * left.error);
  }
};
Outcomes outcomes(Errors errors, ErrorKind kind, double noise) {
  Outcomes out;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Recorded r = recorded(errors, noise, seed);
    const NoisyErrors noisy = errorsOf(r, kind);
    out.add(withoutNoise(noisy), noisy.mean(), exactOf(r, kind));
  }
  return out;
}

TEST(TruthNoise, FloorIsWhatAPerfectTechniqueShows) {
  // Mean |n| of a normal n is √(2/π) of its deviation; changes have twice the variance of what differs between frames.
  std::vector<double> errors, changes, perfect;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    Recorded r = recorded(Errors::Normal, kSize, seed);
    errors.push_back(errorsOf(r, ErrorKind::Error).floor());
    changes.push_back(errorsOf(r, ErrorKind::Change).floor());
    r.technique = r.exact;
    perfect.push_back(errorsOf(r, ErrorKind::Change).mean());
    const UncertainValue left = withoutNoise(errorsOf(r, ErrorKind::Change));
    EXPECT_LT(left.value, 4 * left.error);
    EXPECT_LT(left.error, 0.5 * changes.back());
  }
  const double mean = std::sqrt(2 / double(kPi)) * kSize;
  const Mean e = meanOf(errors), c = meanOf(changes), p = meanOf(perfect);
  EXPECT_LT(std::abs(e.mean - mean) / e.error, kDeviateLimit);
  EXPECT_LT(std::abs(c.mean - mean * std::sqrt(0.2)) / c.error, kDeviateLimit);
  EXPECT_LT(std::abs(c.mean - p.mean) / std::hypot(c.error, p.error), kDeviateLimit);
}

TEST(TruthNoise, NormalNoiseIsTakenOffWithoutBias) {
  for (ErrorKind kind : {ErrorKind::Error, ErrorKind::Change})
    for (double noise : {0.5, 1.0, 2.0}) {
      const Outcomes o = outcomes(Errors::Normal, kind, noise * kSize);
      const Mean off = meanOf(o.off), raw = meanOf(o.raw);
      EXPECT_LT(std::abs(off.mean) / off.error, kDeviateLimit) << int(kind) << ", noise " << noise;
      EXPECT_GT(raw.mean / raw.error, 2 * kDeviateLimit) << int(kind) << ", noise " << noise;
      EXPECT_LT(chiSquareDeviate(o.squares, kSeeds), kDeviateLimit) << "errors are stated too small";
      if (noise < 1) continue;
      EXPECT_LT(meanOf(o.errors).mean, 0.7 * raw.mean) << "nothing would be known";
    }
}

TEST(TruthNoise, OtherErrorsAreNearerThanTheyWere) {
  for (Errors errors : {Errors::Spread, Errors::Rare})
    for (ErrorKind kind : {ErrorKind::Error, ErrorKind::Change})
      for (double noise : {0.5, 1.0, 2.0}) {
        const Outcomes o = outcomes(errors, kind, noise * kSize);
        const Mean off = meanOf(o.off), raw = meanOf(o.raw);
        EXPECT_LT(off.mean, 0.85 * raw.mean) << int(errors) << ", " << int(kind) << ", noise " << noise;
        EXPECT_GT(off.mean, -4 * off.error) << "too much is taken off";
        EXPECT_LT(off.mean, 2 * meanOf(o.errors).mean) << "the model's error is not seen";
      }
}

TEST(TruthNoise, WhereErrorsAreAlikeEverywhereTooMuchIsTakenOff) {
  const Outcomes o = outcomes(Errors::Constant, ErrorKind::Error, 0.5 * kSize);
  const Mean off = meanOf(o.off), error = meanOf(o.errors);
  EXPECT_LT(off.mean, -4 * off.error);
  EXPECT_LT(-off.mean, error.mean); // and that is stated
}

TEST(TruthNoise, ErrorsThatPixelsHaveInCommonAreLessWellKnown) {
  // All light flickers as one: the pixels of a frame tell no more than one of them does.
  Outcomes o;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    Recorded r = recorded(Errors::Normal, 0.25 * kSize, seed);
    Rng random(seed, Stream::Test, 98);
    for (size_t t = 0; t < kFrames; ++t) {
      const double error = kSize * normal(random);
      for (size_t p = 0; p < kPixels; ++p) r.technique[t][p] = float(r.exact[t][p] + error);
    }
    const NoisyErrors noisy = errorsOf(r, ErrorKind::Change);
    o.add(withoutNoise(noisy), noisy.mean(), 2 * kSize / std::sqrt(double(kPi)));
  }
  const Mean off = meanOf(o.off);
  EXPECT_LT(std::abs(off.mean) / off.error, kDeviateLimit);
  EXPECT_LT(chiSquareDeviate(o.squares, kSeeds), kDeviateLimit);
}

TEST(TruthNoise, RatiosOfTwoTechniques) {
  // The second's errors are 0.4 of the first's; both hold the same noise of the truth.
  Outcomes o;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Recorded first = recorded(Errors::Normal, kSize, seed);
    Recorded second = first;
    Rng random(seed, Stream::Test, 99);
    for (size_t t = 0; t < kFrames; ++t)
      for (size_t p = 0; p < kPixels; ++p)
        second.technique[t][p] = float(first.exact[t][p] + 0.4 * kSize * normal(random));
    const NoisyErrors a = errorsOf(second, ErrorKind::Change), b = errorsOf(first, ErrorKind::Change);
    o.add(ratioWithoutNoise(a, b), a.mean() / b.mean(),
          exactOf(second, ErrorKind::Change) / exactOf(first, ErrorKind::Change));
  }
  const Mean off = meanOf(o.off), raw = meanOf(o.raw);
  EXPECT_LT(std::abs(off.mean) / off.error, kDeviateLimit);
  EXPECT_GT(raw.mean, 0.05); // √(0.16 + 0.1)/√1.1 instead of 0.4
  EXPECT_LT(chiSquareDeviate(o.squares, kSeeds), kDeviateLimit);
  EXPECT_LT(meanOf(o.errors).mean, 0.05);
}

TEST(TruthNoise, SeedsAddAndPixelsWithoutSurfaceAreLeftOut) {
  const float none = std::nanf("");
  const PixelSeries technique{{0.6f, none}, {0.8f, none}}, other{{0.4f, none}, {0.4f, none}},
      truth{{0.5f, none}, {0.5f, none}}, a{{0.4f, none}, {0.5f, none}}, b{{0.6f, none}, {0.5f, none}};
  const uint32_t both[] = {0, 1}, second[] = {1};
  NoisyErrors errors, change, nothing;
  for (const PixelSeries* series : {&technique, &other}) {
    addNoisyErrors(errors, ErrorKind::Error, *series, truth, a, b, both);
    addNoisyErrors(change, ErrorKind::Change, *series, truth, a, b, both);
    addNoisyErrors(nothing, ErrorKind::Error, *series, truth, a, b, second);
  }
  EXPECT_EQ(errors.sum().count, 4);
  EXPECT_NEAR(errors.mean(), (0.1 + 0.3 + 0.1 + 0.1) / 4, 1e-6);
  EXPECT_NEAR(errors.sum().halves, 0.1 + 0.3 + 0.1 + 0.1, 1e-6); // .6 against .4 and .6, .4 against these
  EXPECT_NEAR(errors.floor(), 0.1 / 2, 1e-6);                    // 0.1 in the first frame, none in the second
  EXPECT_NEAR(change.mean(), (0.2 + 0.0) / 2, 1e-6);
  EXPECT_NEAR(change.floor(), 0.1, 1e-6); // halves change by +0.1 and −0.1
  EXPECT_EQ(nothing.floor(), 0);
  EXPECT_TRUE(std::isnan(withoutNoise(nothing).value));
  EXPECT_TRUE(std::isnan(ratioWithoutNoise(nothing, nothing).value));
}

} // namespace lambent::test::truth_noise_test
