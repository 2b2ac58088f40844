// Solid angle of a rectangle on the plane z = 1 seen from the origin: of texels of a map with perspective.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// Steradians of [lo.x, hi.x] × [lo.y, hi.y], within 1e-4 of them for sides of up to twice each other's length. The closed form takes differences of angles, which for a single texel leaves
/// no digits; there ∫ (1 + x² + y²)^(−3/2) by Gauss with 2 × 2 points is exact to rounding.
SHARED_INLINE float rectSolidAngle(vec2 lo, vec2 hi) {
  vec2 size = hi - lo, middle = 0.5f * (lo + hi);
  if (size.x * size.y > 0.01f * (1.0f + middle.x * middle.x + middle.y * middle.y)) {
    float sum = 0.0f;
    for (int i = 0; i < 4; ++i) {
      float x = (i & 1) == 0 ? lo.x : hi.x, y = (i & 2) == 0 ? lo.y : hi.y;
      float corner = atan(x * y / sqrt(1.0f + x * x + y * y));
      sum += i == 0 || i == 3 ? corner : -corner;
    }
    return sum;
  }
  float sum = 0.0f;
  for (int i = 0; i < 4; ++i) { // points at (1 ± 1/√3)/2
    float x = lo.x + size.x * ((i & 1) == 0 ? 0.211324865f : 0.788675135f);
    float y = lo.y + size.y * ((i & 2) == 0 ? 0.211324865f : 0.788675135f);
    float square = 1.0f + x * x + y * y;
    sum += 1.0f / (square * sqrt(square));
  }
  return 0.25f * size.x * size.y * sum;
}

SHARED_END
