// Numbers that stand for many; which of several measured ones are smaller, and which only look so. Pure functions.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
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

/// A number that was measured and its standard error. NaN: how well it is known is not known.
struct UncertainValue {
  double value = 0, error = std::numeric_limits<double>::quiet_NaN();
  double degrees = std::numeric_limits<double>::infinity(); // of freedom, of the error itself
};

/// Mean of independent runs, as over seeds. Of one run, the error is NaN. Needs one at least.
UncertainValue meanOver(std::span<const double> runs);

/// A statistic of one technique, as mean |E|, against a truth that is noisy: over the seeds against the truth, and
/// means over the seeds against each half of the truth's samples alone.
struct StatisticRuns {
  std::vector<double> seeds;
  std::vector<double> halves; // two; none of an exact truth
};

/// Means over the seeds, whose standard errors hold three parts: the scatter of the seeds; that of the truth, which is
/// half the difference between its halves (all techniques share the truth: root of the mean square over them); and by
/// how much the truth's noise may raise or lower the statistic itself. What the statistic gains when the truth has half
/// the samples is about what the whole truth's noise has brought, and brings to each technique in its own measure.
std::vector<UncertainValue> estimatesOf(std::span<const StatisticRuns> techniques);

enum class Order { Less, Greater, WithinNoise, Unknown };
/// Whether a is less than b: their difference is beyond what noise makes in one of twenty cases, about two standard
/// errors where there are many runs, and by Student's distribution more where there are few. Unknown where an error is.
Order compared(const UncertainValue& a, const UncertainValue& b);

/// One of several, in a ranking.
struct Ranked {
  std::string name;
  UncertainValue estimate;
};
/// From the least to the greatest.
std::vector<Ranked> ranked(std::vector<Ranked> all);
/// Each with the next: "smc < ir; ir ≈ tcas (within noise)"; "not ranked: …" where an error is unknown. `all` is in
/// order.
std::string rankingText(std::span<const Ranked> all);

} // namespace lambent
