// Single parts of the hall: what is turned on a lathe, and walls with openings. Each stands on y = 0, centred on the
// axis, unless said otherwise.
#pragma once

#include "tools/content/shapes.h"

namespace lambent::content {

/// Column with plinth, moulded base, tapered shaft, capital and abacus; `height` includes all of them.
Geometry column(double height, uint32_t segments = 20);

/// Stub that carries the rail of the balustrade.
Geometry baluster(double height, uint32_t segments = 8);

/// Round basin with a foot and a rim.
Geometry basin();

/// Wall along X between `lo` and `hi` with one rectangular opening through its whole thickness (Z), given by its lower
/// left and upper right corner in x and y. An opening that reaches down to lo.y is a doorway.
Geometry wallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi);

/// The same turned by a quarter: x and z swap places (the opening is given in z and y).
Geometry crossWallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi);

} // namespace lambent::content
