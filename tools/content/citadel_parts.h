// The parts that a house of the citadel's street is made of. Frame of all: x = 0 is the middle of the front, z = 0 its
// outer face, +Z goes into the house, y = 0 the street.
#pragma once

#include "tools/content/shapes.h"

namespace lambent::content {

constexpr double kHouseWidth = 7.0, kHouseDepth = 6.0, kStorey = 3.1; // metres

/// Walls, floors and ceiling: hollow, with a door and a window below and three windows on every storey above.
Geometry houseShell(int storeys);
/// Open shutters, sills, door and window crosses of that shell.
Geometry houseWoodwork(int storeys);
/// Gabled roof on y = 0 with tiles of the given width along the house and length down the slope.
Geometry houseRoof(double tileWidth, double tileLength);
/// Balcony whose floor is at y = 0, with a balustrade; `segments` around a baluster.
Geometry houseBalcony(uint32_t segments);

/// Paving from x = 0 to `length`, `width` across z = 0: square stones, narrower at the top, 2 to 3 cm high.
Geometry cobbles(double length, double width, double pitch);

} // namespace lambent::content
