#include "engine/core/sampling.h"

#include "engine/core/error.h"
#include "shaders/shared/paraboloid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lambent {

vec3 sampleCosineHemisphere(const vec3& n, vec2 u) {
  const float r = std::sqrt(u.x), phi = 2 * kPi * u.y;
  vec3 t, b;
  basisAround(n, t, b);
  const float z = std::sqrt(glm::max(0.0f, 1 - u.x));
  return glm::normalize(t * (r * std::cos(phi)) + b * (r * std::sin(phi)) + n * z);
}

vec2 sampleTriangle(vec2 u) {
  const float s = std::sqrt(u.x);
  return {s * (1 - u.y), s * u.y};
}

vec3 sampleSphere(vec2 u) {
  const float z = 1 - 2 * u.x, r = std::sqrt(glm::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

Distribution::Distribution(std::span<const float> weights) : cdf_(weights.size()) {
  double sum = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    CHECK(weights[i] >= 0);
    cdf_[i] = sum += weights[i];
  }
}

uint32_t Distribution::sample(float u) const {
  CHECK(!empty());
  // upper_bound skips entries of weight zero: their cumulative value equals the one before.
  const auto it = std::upper_bound(cdf_.begin(), cdf_.end(), double(u) * cdf_.back());
  if (it != cdf_.end()) return uint32_t(it - cdf_.begin());
  return uint32_t(std::lower_bound(cdf_.begin(), cdf_.end(), cdf_.back()) - cdf_.begin()); // u rounded up to 1
}

std::pair<uint32_t, float> Distribution::choose(float u) const {
  const uint32_t i = sample(u);
  return {i, glm::clamp((u - cumulative(i)) / probability(i), 0.0f, kBelowOne)};
}

vec3 additiveRecurrence3(uint32_t i, const vec3& shift) {
  // 1/g, 1/g², 1/g³ with g the real root of x⁴ = x + 1; the product is taken in double so large i keep their fraction.
  constexpr double a1 = 0.8191725133961645, a2 = 0.6710436067037893, a3 = 0.5497004779019703;
  const auto wrap = [](double x) { return float(x - std::floor(x)); };
  vec3 p(wrap(shift.x + i * a1), wrap(shift.y + i * a2), wrap(shift.z + i * a3));
  return glm::min(p, vec3(kBelowOne)); // float rounding may reach 1
}

std::vector<uint32_t> spreadOrder(uint32_t count, double step) {
  std::vector<uint32_t> byValue(count), order(count);
  std::iota(byValue.begin(), byValue.end(), 0);
  const auto value = [&](uint32_t i) { return i * step - std::floor(i * step); };
  std::sort(byValue.begin(), byValue.end(), [&](uint32_t a, uint32_t b) { return value(a) < value(b); });
  for (uint32_t rank = 0; rank < count; ++rank) order[byValue[rank]] = rank;
  return order;
}

uint32_t alongCurve(const uvec3& cell) {
  const auto spread = [](uint32_t v) { // ten bits to every third
    v = (v | v << 16) & 0x030000ff;
    v = (v | v << 8) & 0x0300f00f;
    v = (v | v << 4) & 0x030c30c3;
    return (v | v << 2) & 0x09249249;
  };
  return spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2;
}

} // namespace lambent
