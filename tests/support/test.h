// What every test uses: numbers, pixels, statistics, and how much of them a test may ask for.
#pragma once

#include "engine/core/error.h"
#include "engine/core/math.h"
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "tests/support/effort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace lambent::test {

struct Pixel {
  int x, y;
};

/// All pixels of an image, row by row.
class Pixels {
 public:
  class Iterator {
   public:
    Iterator(Pixel at, int firstX, int endX) : at_(at), firstX_(firstX), endX_(endX) {}
    Pixel operator*() const { return at_; }
    Iterator& operator++() {
      if (++at_.x == endX_) at_ = {firstX_, at_.y + 1};
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_.y != other.at_.y || at_.x != other.at_.x; }

   private:
    Pixel at_;
    int firstX_, endX_;
  };
  Pixels(int width, int height) : first_{0, 0}, end_{width, height} {}
  Pixels(Pixel first, Pixel end) : first_(first), end_(end) {} // up to, not with `end`
  template <class Image> explicit Pixels(const Image& image) : Pixels(image.width, image.height) {}

  Iterator begin() const { return {first_, first_.x, end_.x}; }
  Iterator end() const { return {{first_.x, end_.y}, first_.x, end_.x}; }

 private:
  Pixel first_, end_;
};

// Statistics with a stated confidence

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
