// How far a picture is from a truth that knows itself only so well.
#pragma once

#include "gi/measure/picture_error.h"
#include "gi/reference/path_tracer.h"

#include <optional>

namespace lambent {

struct AgainstTruth {
  PictureError error;     // of the picture, what the truth does not know included
  double truthRmse = 0;   // expected of the truth, by its own standard error; infinite for a single sample
  double truthRelMse = 0; // likewise
  double truthBias = 0;   // standard error of the truth's mean over that mean

  /// Less than half of the squared error is the truth's own.
  bool known() const { return 2 * truthRmse * truthRmse < error.rmse * error.rmse; }
  /// RMSE without what the truth does not know; none where that is too much of it.
  std::optional<double> pictureRmse() const;
  /// Milliseconds in which path tracing comes as near (relMSE) as the picture, when the truth took `truthMs`; none
  /// where the picture's own error is not known.
  std::optional<double> pathTracingMs(double truthMs) const;
};
AgainstTruth againstTruth(const Image& picture, const ReferencePicture& truth);

} // namespace lambent
