// Numbers that stand for many.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lambent {

/// How values scatter. All zero where there is none.
struct Spread {
  double median = 0; // the upper of the two in the middle
  double least = 0, quarter = 0, threeQuarters = 0, most = 0;
  size_t count = 0;
};
Spread spreadOf(std::vector<double> values);

/// The exponent e for which y ∝ x^e fits best: slope of least squares between the logarithms. Values above 0, two
/// different x at least.
double exponentOf(std::span<const double> x, std::span<const double> y);

/// Standard error of that exponent, from how far the values are off the fit; NaN of fewer than three.
double exponentError(std::span<const double> x, std::span<const double> y);

} // namespace lambent
