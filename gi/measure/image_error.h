// How far one picture is from another, or from a truth that knows itself only so well.
#pragma once

#include "engine/image/image.h"
#include "gi/reference/path_tracer.h"

#include <optional>

namespace lambent {

/// Over all channels of the pixels that count; those with NaN or infinity in either picture are left out and counted.
struct ImageError {
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
ImageError imageError(const Image& picture, const Image& truth, const Image& mask = {});

/// ImageError::relMse to expect of an unbiased picture with this mean and these standard errors of its values,
/// against the exact one. Pixels that are not finite in either are left out.
double expectedRelMse(const Image& mean, const Image& standardError);

/// Mask of all pixels but the truth's brightest: 1 but in that share of the pixels, by luminance.
Image allButBrightest(const Image& truth, double share);

/// Share of the whole blocks of size × size pixels whose mean luminance is within `tolerance` (a share) of the truth's.
/// Blocks that are black in the truth count as within where they are black in the picture.
double blocksWithin(const Image& picture, const Image& truth, int size, double tolerance);

/// Milliseconds in which path tracing comes as near as a picture that is `relMse` off a truth which took `truthMs` and
/// is itself `ofTruth` off: squared errors fall as samples rise. What the truth does not know is no error of the
/// picture; none where that is half of it or more.
std::optional<double> pathTracingMs(double relMse, double ofTruth, double truthMs);
/// The bar: path tracing takes at least so many times the time of a frame to its error.
constexpr double kPathTracingTimes = 20;

struct AgainstTruth {
  ImageError error;       // of the picture, what the truth does not know included
  double truthRmse = 0;   // expected of the truth, by its own standard error; infinite for a single sample
  double truthRelMse = 0; // likewise
  double truthBias = 0;   // standard error of the truth's mean over that mean

  /// Less than half of the squared error is the truth's own.
  bool known() const { return 2 * truthRmse * truthRmse < error.rmse * error.rmse; }
  /// RMSE without what the truth does not know; none where that is too much of it.
  std::optional<double> imageRmse() const;
};
AgainstTruth againstTruth(const Image& picture, const ReferenceImage& truth);

} // namespace lambent
