// Numbered rings on a picture.
#pragma once

#include "engine/core/image.h"

#include <span>

namespace lambent {

/// Around each point (u right, v down, 0 to 1) a ring, and beside it the point's index, white on black. `shown` holds
/// values of the display.
void drawMarks(Image& shown, std::span<const vec2> points);

} // namespace lambent
