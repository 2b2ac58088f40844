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

} // namespace lambent
