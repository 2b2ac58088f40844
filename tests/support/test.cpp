#include "tests/support/test.h"

namespace lambent::test {

double chiSquareDeviate(double statistic, double degrees) {
  const double c = 2.0 / (9.0 * degrees);
  return (std::cbrt(statistic / degrees) - (1 - c)) / std::sqrt(c);
}

double chiSquareDeviate(std::span<const double> observed, std::span<const double> expected) {
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

::testing::AssertionResult agrees(const Mean& mean, const Mean& wanted, double mostError, double slack) {
  const auto result = [&] {
    if (!(mean.error < mostError)) return ::testing::AssertionFailure() << "too noisy to tell: ";
    if (!(std::abs(mean.mean - wanted.mean) < kDeviateLimit * std::hypot(mean.error, wanted.error) + slack))
      return ::testing::AssertionFailure();
    return ::testing::AssertionSuccess();
  }();
  return ::testing::AssertionResult(result)
         << mean.mean << " +- " << mean.error << " against " << wanted.mean << " +- " << wanted.error;
}

} // namespace lambent::test
