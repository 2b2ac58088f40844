// The exposure that suits an image.
#pragma once

#include <cmath>
#include <span>

namespace lambent {

/// Sums over surfaces of a part of an image that are not black: of luminance, of its logarithm, and how many there are.
struct LightSums {
  double logs = 0, light = 0, count = 0;
};

/// Returns the factor that takes the log-average luminance to 0.18, as far as parts say something about it: those
/// darker than a hundredth of the mean do as little as black ones, or the night around a lamp would burn out what it
/// lights. 0: there is no light.
inline float exposureOf(std::span<const LightSums> parts) {
  constexpr double kMidGrey = 0.18, kDark = 0.01;
  LightSums all, counted;
  for (const LightSums& p : parts) all.light += p.light, all.count += p.count;
  if (!(all.count > 0)) return 0;
  const double least = std::log(kDark * all.light / all.count);
  for (const LightSums& p : parts)
    if (p.count > 0 && p.logs >= least * p.count) counted.logs += p.logs, counted.count += p.count;
  return counted.count > 0 ? float(kMidGrey / std::exp(counted.logs / counted.count)) : 0;
}

} // namespace lambent
