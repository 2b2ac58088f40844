// How far one picture is from another.
#pragma once

#include "engine/core/image.h"

namespace lambent {

/// Root of the mean square of the difference, over all channels of all pixels. Both have the same size.
double rmse(const Image& picture, const Image& truth);

/// Mean over all channels of all pixels.
double meanOf(const Image& picture);

/// rmse over the truth's mean: 0 for equal pictures, infinity where the truth alone is black.
double rmseShare(const Image& picture, const Image& truth);

} // namespace lambent
