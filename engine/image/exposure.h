// The exposure that suits an image.
#pragma once

#include "engine/core/color.h"
#include "engine/core/math.h"

#include <cmath>
#include <span>

namespace lambent {

/// What an image asks for, as sums over its surfaces that are neither black nor infinite. A surface weighs
/// y²/(y² + dark²): one much darker than what there is to see says as little as a black one, or the night around a lamp
/// would burn out what it lights.
struct ExposureSums {
  double logs = 0, weights = 0; // of weighted log luminance, of the weights
  double roots = 0, count = 0;  // of square roots of luminance, of surfaces

  void add(double luminance, double dark) {
    if (!(luminance > 0) || !std::isfinite(luminance)) return;
    const double relative = dark / luminance, weight = 1 / (1 + relative * relative);
    logs += weight * std::log(luminance);
    weights += weight;
    roots += std::sqrt(luminance);
    count += 1;
  }
  /// Luminance that has half a weight: a fiftieth of the squared mean root. The mean itself follows a lamp in view, or
  /// a patch of sun, so far that the room around it would weigh nothing.
  double dark() const { return count > 0 ? (roots / count) * (roots / count) / 50 : 0; }
  /// The factor that takes the weighted log-average to mid grey; 0: there is no light.
  float exposure() const { return weights > 0 ? float(0.18 / std::exp(logs / weights)) : 0; }
};

/// Sums over the radiance of surfaces.
inline ExposureSums sumForExposure(std::span<const vec3> radiance) {
  ExposureSums even, sums;
  for (const vec3& r : radiance) even.add(double(luminance(r)), 0);
  for (const vec3& r : radiance) sums.add(double(luminance(r)), even.dark());
  return sums;
}

/// The exposure that suits the radiance of surfaces; 1 without light.
inline float exposureFor(std::span<const vec3> radiance) {
  const float exposure = sumForExposure(radiance).exposure();
  return exposure > 0 ? exposure : 1;
}

} // namespace lambent
