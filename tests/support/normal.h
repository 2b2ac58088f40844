#pragma once

#include "engine/core/rng.h"

#include <cmath>

namespace lambent::test {

/// Standard normal deviate, by Box and Muller.
inline double normal(Rng& random) {
  const double r = std::sqrt(-2 * std::log(1 - double(random.next())));
  return r * std::cos(2 * double(kPi) * double(random.next()));
}

} // namespace lambent::test
