// Statistical tests with a stated confidence.
#pragma once

#include "tests/support/test.h"

namespace lambent::test {

/// Standard normal deviate of a chi-square statistic (Wilson–Hilferty): above 4.0 happens once in 31 000 good runs.
double chiSquareDeviate(double statistic, double degrees);
/// Deviate of observed counts against expected ones; cells that expect fewer than 5 are pooled.
double chiSquareDeviate(std::span<const double> observed, std::span<const double> expected);

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

/// Whether it is the number wanted but for chance and `slack`, and known better than to `mostError`: else it cannot
/// tell.
::testing::AssertionResult agrees(const Mean& mean, const Mean& wanted, double mostError, double slack = 0);
inline ::testing::AssertionResult agrees(const Mean& mean, double wanted, double mostError, double slack = 0) {
  return agrees(mean, Mean{wanted}, mostError, slack);
}

} // namespace lambent::test
