#include "gi/measure/truth_noise.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace lambent {

namespace {

constexpr size_t kParts = 10; // of the frames; long beside what consecutive changes have in common
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double squared(double x) { return x * x; }

/// Of s², m being the whole truth's or the halves'.
double squareWithoutNoise(const NoisySums& s) { return (squared(s.whole) - squared(s.noise)) / squared(s.count); }
double squareFromHalves(const NoisySums& s) { return (squared(s.halves) - 2 * squared(s.noise)) / squared(s.count); }

/// Squares, as these behave where noise is all there is.
struct Squares {
  double whole = kUnknown, halves = kUnknown;
};
Squares squaresOf(const NoisySums& s) {
  if (!(s.count > 0)) return {};
  return {squareWithoutNoise(s), squareFromHalves(s)};
}
Squares squaresOf(const NoisySums& a, const NoisySums& b) {
  const Squares of = squaresOf(a), over = squaresOf(b);
  if (!(over.whole > 0)) return {};
  return {of.whole / over.whole, over.halves > 0 ? of.halves / over.halves : kUnknown};
}

/// Variance of a value by the values without each group (jackknife). 0 of fewer than two groups with values.
double jackknifed(size_t groups, const std::function<bool(size_t)>& any,
                  const std::function<double(size_t)>& valueWithout) {
  std::vector<double> values;
  for (size_t g = 0; g < groups; ++g)
    if (any(g)) values.push_back(valueWithout(g));
  if (values.size() < 2) return 0;
  const double error = meanOver(values).error; // √(Σ(v − mean)²/(n − 1)/n)
  return squared(double(values.size() - 1) * error);
}

/// The root, with the larger of its errors upwards and downwards; finite at 0.
UncertainValue rootOf(const Squares& squares, double variance) {
  if (std::isnan(squares.whole)) return {kUnknown, kUnknown};
  const double missed = (squares.halves - squares.whole) / (std::sqrt(2.0) - 1);
  const double error = std::sqrt(variance + squared(missed)), least = std::max(0.0, squares.whole);
  const double root = std::sqrt(least), up = std::sqrt(least + error), down = std::sqrt(std::max(0.0, least - error));
  return {root, std::max(up - root, root - down)};
}

} // namespace

NoisySums& NoisySums::operator+=(const NoisySums& b) {
  whole += b.whole, halves += b.halves, noise += b.noise, count += b.count;
  return *this;
}

NoisySums NoisySums::operator-(const NoisySums& b) const {
  return {whole - b.whole, halves - b.halves, noise - b.noise, count - b.count};
}

NoisySums NoisyErrors::sum() const {
  NoisySums sum;
  for (const NoisySums& s : pixels) sum += s;
  return sum;
}

double NoisyErrors::mean() const {
  const NoisySums s = sum();
  return s.count > 0 ? s.whole / s.count : 0;
}

double NoisyErrors::floor() const {
  const NoisySums s = sum();
  return s.count > 0 ? s.noise / s.count : 0;
}

void addNoisyErrors(NoisyErrors& to, ErrorKind kind, const PixelSeries& technique, const PixelSeries& truth,
                    const PixelSeries& halfA, const PixelSeries& halfB, std::span<const uint32_t> pixels) {
  CHECK_EQ(technique.size(), truth.size());
  to.pixels.resize(pixels.size());
  to.parts.resize(kParts);
  for (size_t t = kind == ErrorKind::Change ? 1 : 0; t < truth.size(); ++t)
    for (size_t i = 0; i < pixels.size(); ++i) {
      const uint32_t p = pixels[i];
      const auto of = [&](const PixelSeries& series) {
        return double(series[t][p]) - (kind == ErrorKind::Change ? series[t - 1][p] : 0);
      };
      const double value = of(technique), a = of(halfA), b = of(halfB);
      const NoisySums one{std::abs(value - of(truth)), 0.5 * (std::abs(value - a) + std::abs(value - b)),
                          0.5 * std::abs(a - b), 1};
      if (std::isnan(one.whole)) continue;
      to.pixels[i] += one;
      to.parts[t * kParts / truth.size()] += one;
    }
}

UncertainValue withoutNoise(const NoisyErrors& errors) {
  const NoisySums sum = errors.sum();
  const auto over = [&](const std::vector<NoisySums>& groups) {
    return jackknifed(
        groups.size(), [&](size_t g) { return groups[g].count > 0; },
        [&](size_t g) { return squaresOf(sum - groups[g]).whole; });
  };
  const double variance = over(errors.pixels) + over(errors.parts);
  return rootOf(squaresOf(sum), variance > 0 ? variance : kUnknown);
}

UncertainValue ratioWithoutNoise(const NoisyErrors& a, const NoisyErrors& b) {
  const NoisySums sumA = a.sum(), sumB = b.sum();
  const auto over = [&](const std::vector<NoisySums>& ofA, const std::vector<NoisySums>& ofB) {
    CHECK_EQ(ofA.size(), ofB.size());
    return jackknifed(
        ofA.size(), [&](size_t g) { return ofA[g].count > 0; },
        [&](size_t g) { return squaresOf(sumA - ofA[g], sumB - ofB[g]).whole; });
  };
  const double variance = over(a.pixels, b.pixels) + over(a.parts, b.parts);
  return rootOf(squaresOf(sumA, sumB), variance > 0 ? variance : kUnknown);
}

} // namespace lambent
