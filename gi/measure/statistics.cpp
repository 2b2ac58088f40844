#include "gi/measure/statistics.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>

namespace lambent {

Spread spreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return {values[n / 2], values.front(), values[n / 4], values[n * 3 / 4], values.back(), n};
}

double exponentOf(std::span<const double> x, std::span<const double> y) {
  CHECK_EQ(x.size(), y.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  const double n = double(x.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

} // namespace lambent
