// Statistical tests with a stated confidence.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace lambent::test {

/// Standard normal deviate of a chi-square statistic (Wilson–Hilferty): above 4.0 happens once in 31 000 good runs.
inline double chiSquareDeviate(double statistic, double degrees) {
  const double c = 2.0 / (9.0 * degrees);
  return (std::cbrt(statistic / degrees) - (1 - c)) / std::sqrt(c);
}

/// Deviate of observed counts against expected ones; cells that expect fewer than 5 are pooled.
inline double chiSquareDeviate(std::span<const double> observed, std::span<const double> expected) {
  double statistic = 0, pooledObserved = 0, pooledExpected = 0;
  int cells = 0;
  for (size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] < 5) {
      pooledObserved += observed[i];
      pooledExpected += expected[i];
      continue;
    }
    statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
    ++cells;
  }
  if (pooledExpected > 0) {
    statistic += (pooledObserved - pooledExpected) * (pooledObserved - pooledExpected) / pooledExpected;
    ++cells;
  } else if (pooledObserved > 0) {
    return 1e9; // something where nothing may be
  }
  return chiSquareDeviate(statistic, cells - 1);
}

/// Bound on |z| used by all tests here: two-sided probability 6e-5 for one comparison.
inline constexpr double kDeviateLimit = 4.0;

/// Mean and standard error of independent values.
struct Mean {
  double mean = 0, error = 0;
};
template <class Range> Mean meanOf(const Range& values) {
  double sum = 0, squares = 0, n = 0;
  for (double v : values) sum += v, squares += v * v, ++n;
  const double mean = sum / n;
  return {mean, std::sqrt(std::fmax(0, squares / n - mean * mean) / std::fmax(1, n - 1))};
}

} // namespace lambent::test
