// Sampling functions: uniforms in, value out; each with its density. Checked by chi-square tests.
#pragma once

#include "engine/core/math.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace lambent {

/// The largest float below 1: the end of [0, 1) for numbers that rounding may carry there.
inline constexpr float kBelowOne = 0x1.fffffep-1f;

/// Unit direction with density cosθ/π around unit `n` (Malley's method on polar coordinates).
vec3 sampleCosineHemisphere(const vec3& n, vec2 u);
/// Density per steradian of sampleCosineHemisphere; 0 below the surface.
inline float pdfCosineHemisphere(float cosTheta) { return glm::max(0.0f, cosTheta) / kPi; }

/// Barycentric weights (of the second and third corner), uniform over a triangle's area: density 1/area.
vec2 sampleTriangle(vec2 u);

/// Unit direction, uniform over the sphere: density 1/(4π).
vec3 sampleSphere(vec2 u);

/// Discrete choice with given weights, by inversion of the cumulative sum (kept in double: the last entry is the
/// total).
class Distribution {
 public:
  Distribution() = default;
  explicit Distribution(std::span<const float> weights);

  bool empty() const { return cdf_.empty() || cdf_.back() <= 0; }
  double total() const { return cdf_.empty() ? 0 : cdf_.back(); }
  size_t size() const { return cdf_.size(); }
  /// Index with probability weight/total, never one of weight zero. Requires !empty().
  uint32_t sample(float u) const;
  /// That index, and where u lies within its share: in [0, 1), uniform as u is. Requires !empty().
  std::pair<uint32_t, float> choose(float u) const;
  /// Share of the total before entry i: the least u that sample() answers with it. Requires !empty().
  float cumulative(uint32_t i) const { return i ? float(cdf_[i - 1] / cdf_.back()) : 0; }
  float probability(uint32_t i) const { return empty() ? 0 : float((cdf_[i] - (i ? cdf_[i - 1] : 0)) / cdf_.back()); }

 private:
  std::vector<double> cdf_;
};

/// i-th point of the additive recurrence with the plastic-number family (Roberts 2018, "R3"), shifted by `shift`:
/// low-discrepancy in each pair of coordinates for any prefix.
vec3 additiveRecurrence3(uint32_t i, const vec3& shift);

/// Numbers 0 … count − 1 in the order of the additive recurrence of `step`: neighbours in the list are far apart, and
/// so are the places of neighbouring numbers.
std::vector<uint32_t> spreadOrder(uint32_t count, double step);

/// Number of a cell along a Morton curve, which fills a cube of 1024³ cells: cells near along it are near in space.
uint32_t alongCurve(const uvec3& cell);

} // namespace lambent
