// Columns, movable things and lamps of the generated scenes. Each stands on y = 0, centred on the vertical axis, unless
// said otherwise.
#pragma once

#include "tools/content/shapes.h"

namespace lambent::content {

/// Column with plinth, moulded base, tapered shaft, capital and abacus; `height` includes all of them.
Geometry column(double height, uint32_t segments = 20);
/// Stub that carries the rail of a balustrade.
Geometry baluster(double height, uint32_t segments = 8);

/// Round basin with a foot and a rim, and the water in it.
Geometry basin();
Geometry basinWater();

/// Swivel chair, its back towards +Z.
Geometry chair(uint32_t segments);

/// Table top on four legs or, with `pedestals`, on two blocks of drawers.
Geometry table(double width, double depth, bool pedestals);

/// Keyboard and screen for a table top; the keyboard's own keys cost 12 triangles each.
Geometry screen();
Geometry keyboard(uint32_t columns);

/// Paving from x = 0 to `length`, `width` across z = 0: square stones, narrower at the top, 2 to 3 cm high.
Geometry cobbles(double length, double width, double pitch);

/// Seat on two legs, alike on both sides: the one at +X is given.
Geometry bench(const dvec3& seatLo, const dvec3& seatHi, const dvec3& legLo, const dvec3& legHi);

/// Open shelf with its back towards -Z, `boards` compartments high.
Geometry shelf(double width, double height, double depth, uint32_t boards);
/// Upright books that fill that shelf, only those of every third kind `kind` (0, 1, 2), for three colours.
Geometry books(double width, double height, double depth, uint32_t boards, uint32_t kind, double meanThickness);

Geometry pot(double radius, double height, uint32_t segments);
/// Arched leaves from a stem at y = `height`: sheets.
Geometry fronds(uint32_t count, double length, double height, uint32_t steps);

Geometry barrel(uint32_t segments);
Geometry mug(uint32_t segments);

/// Shade that hangs with its top at y = 0, open downwards; a lamp fits 0.12 m below its rim.
Geometry lampShade(uint32_t segments);

/// Block with a foot and a cap, for a sculpture.
Geometry plinth(double width, double depth, double height);

/// Sheet between two corners at the same height that faces down.
Geometry downwardSheet(const dvec3& lo, const dvec3& hi);

/// Flat fixture on a ceiling at y = 0, and the sheet 1 cm below it that emits downwards.
Geometry panelHousing(double width, double depth);
Geometry panelEmitter(double width, double depth);

} // namespace lambent::content
