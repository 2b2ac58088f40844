// How far a picture is from a truth that knows itself only so well.
#pragma once

#include "gi/measure/picture_error.h"
#include "gi/reference/path_tracer.h"

#include <optional>

namespace lambent {

/// Milliseconds in which path tracing comes as near as a picture that is `relMse` off a truth which took `truthMs` and
/// is itself `ofTruth` off: squared errors fall as samples rise. What the truth does not know is no error of the
/// picture; none where that is half of it or more.
std::optional<double> pathTracingMs(double relMse, double ofTruth, double truthMs);
/// The bar: path tracing takes at least so many times the time of a frame to its error.
constexpr double kPathTracingTimes = 20;

struct AgainstTruth {
  PictureError error;     // of the picture, what the truth does not know included
  double truthRmse = 0;   // expected of the truth, by its own standard error; infinite for a single sample
  double truthRelMse = 0; // likewise
  double truthBias = 0;   // standard error of the truth's mean over that mean

  /// Less than half of the squared error is the truth's own.
  bool known() const { return 2 * truthRmse * truthRmse < error.rmse * error.rmse; }
  /// RMSE without what the truth does not know; none where that is too much of it.
  std::optional<double> pictureRmse() const;
};
AgainstTruth againstTruth(const Image& picture, const ReferencePicture& truth);

} // namespace lambent
