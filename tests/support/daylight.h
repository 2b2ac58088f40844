// Daylight for tests, and integrals over directions in double precision.
#pragma once

#include "engine/view/sky.h"
#include "tests/support/test.h"

namespace lambent::test {

/// Degrees; azimuth from +Z towards +X, as --daylight.
inline vec3 directionAt(float elevation, float azimuth) {
  const float up = glm::radians(elevation), around = glm::radians(azimuth);
  return glm::normalize(vec3(std::cos(up) * std::sin(around), std::sin(up), std::cos(up) * std::cos(around)));
}

/// ∫ f(direction) dω over the sphere, midpoint rule in 2·rows² cells of equal solid angle; none reaches over the
/// horizon.
template <class F> auto overSphere(int rows, const F& f) {
  const int columns = 2 * rows;
  const double pi = std::acos(-1.0), cell = 4 * pi / rows / columns;
  decltype(f(vec3(0)) * 1.0) sum(0);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double y = 1 - (2 * row + 1.0) / rows, r = std::sqrt(1 - y * y), phi = 2 * pi * (column + 0.5) / columns;
      sum += f(vec3(float(r * std::cos(phi)), float(y), float(r * std::sin(phi)))) * cell;
    }
  return sum;
}

/// Irradiance that an open sky brings to a surface of unit `normal`.
inline dvec3 openIrradiance(const Sky& sky, const vec3& normal, int rows = 512) {
  return overSphere(
      rows, [&](const vec3& d) { return dvec3(sky.radiance(d)) * std::max(0.0, glm::dot(dvec3(normal), dvec3(d))); });
}

} // namespace lambent::test
