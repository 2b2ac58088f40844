// When a set of VPLs in a still world has nothing left to gain. By paper 1's rule alone it would churn for ever: the
// candidates are other places in every frame, and some are always stronger than 95 % of the set.
#pragma once

#include <algorithm>
#include <cstdint>

namespace lambent {

/// Watches the number of strong candidates per iteration. While the set improves it falls; in the end it wavers around
/// a level that replacing does not lower. So its mean is taken over windows long enough for a quarter of the set to
/// be replaced, and the set has settled when the lowest mean was not undercut by 1/32 for four windows, and no VPL is
/// unverified. A pause in the fall that is shorter than a whole turnover of the set is not taken for its end.
class Settling {
 public:
  static constexpr uint32_t kPatience = 4;

  void restart() { *this = {}; }

  void observe(uint32_t strong, uint32_t unverified, int vpls, int moves) {
    if (moves <= 0) {
      settled_ = unverified == 0; // nothing can be replaced
      return;
    }
    sum_ += strong;
    const uint32_t window = std::max(32u, uint32_t((vpls + 4 * moves - 1) / (4 * moves)));
    if (++frames_ >= window) {
      const double mean = sum_ / frames_;
      if (windows_ == 0 || mean < lowest_ * (1 - 1.0 / 32)) {
        lowest_ = mean;
        waited_ = 0;
      } else {
        ++waited_;
      }
      ++windows_;
      frames_ = 0;
      sum_ = 0;
    }
    settled_ = waited_ >= kPatience && unverified == 0;
  }

  bool settled() const { return settled_; }

 private:
  uint32_t frames_ = 0, windows_ = 0, waited_ = 0; // frames of the present window; windows; those since the lowest
  double sum_ = 0, lowest_ = 0;
  bool settled_ = false;
};

} // namespace lambent
