#include "gi/measure/statistics.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lambent {

Spread spreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return {values[n / 2], values.front(), values[n / 4], values[n * 3 / 4], values.back(), n};
}

namespace {

/// Least squares of log y over log x.
struct Line {
  double slope = 0;
  double squaresX = 0; // of log x about its mean
  double residues = 0; // of log y about the line, squared
};
Line lineThrough(std::span<const double> x, std::span<const double> y) {
  CHECK_EQ(x.size(), y.size());
  const double n = double(x.size());
  double meanX = 0, meanY = 0;
  for (size_t i = 0; i < x.size(); ++i) meanX += std::log(x[i]) / n, meanY += std::log(y[i]) / n;
  Line line;
  double products = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]) - meanX;
    line.squaresX += a * a;
    products += a * (std::log(y[i]) - meanY);
  }
  line.slope = products / line.squaresX;
  for (size_t i = 0; i < x.size(); ++i) {
    const double off = std::log(y[i]) - meanY - line.slope * (std::log(x[i]) - meanX);
    line.residues += off * off;
  }
  return line;
}

} // namespace

double exponentOf(std::span<const double> x, std::span<const double> y) { return lineThrough(x, y).slope; }

double exponentError(std::span<const double> x, std::span<const double> y) {
  if (x.size() < 3) return std::numeric_limits<double>::quiet_NaN();
  const Line line = lineThrough(x, y);
  return std::sqrt(line.residues / double(x.size() - 2) / line.squaresX);
}

namespace {

double square(double x) { return x * x; }

/// Two-sided 95 % quantile of Student's t, by its expansion in 1/degrees (Abramowitz and Stegun 26.7.5); 3 % low at 2,
/// a quarter at 1.
double studentQuantile(double degrees) {
  constexpr double z = 1.959964, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * degrees) + (5 * z5 + 16 * z3 + 3 * z) / (96 * degrees * degrees) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * degrees * degrees * degrees);
}

} // namespace

UncertainValue meanOver(std::span<const double> runs) {
  CHECK(!runs.empty());
  const double n = double(runs.size());
  UncertainValue mean{0, std::numeric_limits<double>::quiet_NaN(), n - 1};
  for (double run : runs) mean.value += run / n;
  if (runs.size() < 2) return mean;
  double squares = 0;
  for (double run : runs) squares += square(run - mean.value);
  mean.error = std::sqrt(squares / (n - 1) / n);
  return mean;
}

std::vector<UncertainValue> estimatesOf(std::span<const StatisticRuns> techniques) {
  std::vector<UncertainValue> out;
  double ofTruth = 0; // variance
  size_t halved = 0;
  for (const StatisticRuns& t : techniques) {
    out.push_back(meanOver(t.seeds));
    if (t.halves.empty()) continue;
    CHECK_EQ(t.halves.size(), size_t(2));
    ofTruth += square(0.5 * (t.halves[0] - t.halves[1]));
    ++halved;
  }
  for (size_t i = 0; i < out.size(); ++i) {
    if (techniques[i].halves.empty()) continue;
    const double gain = 0.5 * (techniques[i].halves[0] + techniques[i].halves[1]) - out[i].value;
    const double ofSeeds = square(out[i].error), all = ofSeeds + ofTruth / double(halved) + square(gain);
    out[i].error = std::sqrt(all);
    if (ofSeeds > 0)
      out[i].degrees *= square(all / ofSeeds); // Welch and Satterthwaite: the scatter of seeds alone has few
  }
  return out;
}

Order compared(const UncertainValue& a, const UncertainValue& b) {
  const double varianceA = square(a.error), varianceB = square(b.error), variance = varianceA + varianceB;
  if (std::isnan(variance)) return Order::Unknown;
  const double degrees = square(variance) / (square(varianceA) / a.degrees + square(varianceB) / b.degrees);
  const double most = variance > 0 ? std::sqrt(variance) * studentQuantile(degrees) : 0;
  if (std::abs(a.value - b.value) <= most) return Order::WithinNoise;
  return a.value < b.value ? Order::Less : Order::Greater;
}

std::vector<Ranked> ranked(std::vector<Ranked> all) {
  std::ranges::stable_sort(all, {}, [](const Ranked& r) { return r.estimate.value; });
  return all;
}

std::string rankingText(std::span<const Ranked> all) {
  std::string text;
  for (size_t i = 0; i + 1 < all.size(); ++i) {
    const Order order = compared(all[i].estimate, all[i + 1].estimate);
    if (order == Order::Unknown) return "not ranked: the noise over seeds is unknown (two seeds or more tell)";
    const bool less = order == Order::Less;
    text += (i ? "; " : "") + all[i].name + (less ? " < " : " ≈ ") + all[i + 1].name + (less ? "" : " (within noise)");
  }
  return text;
}

} // namespace lambent
