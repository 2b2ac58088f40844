// Pieces of area lights made by hand.
#pragma once

#include "shaders/shared/area_piece.h"
#include "tests/support/test.h"

namespace lambent::test {

/// A parallelogram of radiance 1 whose front is along cross(e1, e2).
inline AreaPiece quadPiece(const vec3& corner, const vec3& e1, const vec3& e2, bool doubleSided = false) {
  AreaPiece piece{};
  piece.corners[0] = vec4(corner, 4);
  piece.corners[1] = vec4(corner + e1, 0);
  piece.corners[2] = vec4(corner + e1 + e2, 0);
  piece.corners[3] = vec4(corner + e2, 0);
  const vec3 n = glm::cross(e1, e2);
  piece.normalArea = vec4(glm::normalize(n), glm::length(n));
  piece.radianceSides = vec4(vec3(1), doubleSided ? 1 : 0);
  return piece;
}

} // namespace lambent::test
