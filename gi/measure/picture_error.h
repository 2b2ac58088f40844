// How far one picture is from another.
#pragma once

#include "engine/core/image.h"

namespace lambent {

/// Over all channels of the pixels that count; those with NaN or infinity in either picture are left out and counted.
struct PictureError {
  double rmse = 0;
  double relMse = 0;    // mean of (a − b)²/(b² + 0.01)
  double bias = 0;      // mean of a − b over the mean of b; 0 where that is black
  double largest = 0;   // |a − b|
  double meanTruth = 0; // of b
  size_t pixels = 0, notFinite = 0;

  /// rmse over the truth's mean: 0 for equal pictures, infinity where the truth alone is black.
  double rmseShare() const { return rmse > 0 ? rmse / meanTruth : 0; }
};
/// Of pictures of the same size, where `mask` (none: everywhere) is above 0.
PictureError pictureError(const Image& picture, const Image& truth, const Image& mask = {});

/// PictureError::relMse to expect of an unbiased picture with this mean and these standard errors of its values,
/// against the exact one. Pixels that are not finite in either are left out.
double expectedRelMse(const Image& mean, const Image& standardError);

/// Mask of all pixels but the truth's brightest: 1 but in that share of the pixels, by luminance.
Image allButBrightest(const Image& truth, double share);

/// Share of the whole blocks of size × size pixels whose mean luminance is within `tolerance` (a share) of the truth's.
/// Blocks that are black in the truth count as within where they are black in the picture.
double blocksWithin(const Image& picture, const Image& truth, int size, double tolerance);

} // namespace lambent
