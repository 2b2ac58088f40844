#include "gi/measure/against_truth.h"

#include <cmath>

namespace lambent {

std::optional<double> AgainstTruth::pictureRmse() const {
  if (!known()) return {};
  return std::sqrt(error.rmse * error.rmse - truthRmse * truthRmse);
}

std::optional<double> AgainstTruth::pathTracingMs(double truthMs) const {
  if (!known() || !(error.relMse > truthRelMse)) return {};
  return truthMs * truthRelMse / (error.relMse - truthRelMse); // squared errors fall as samples rise
}

AgainstTruth againstTruth(const Image& picture, const ReferencePicture& truth) {
  AgainstTruth out{.error = pictureError(picture, truth.mean)};
  out.truthRmse = truth.relativeError * out.error.meanTruth;
  out.truthRelMse = expectedRelMse(truth.mean, truth.error);
  out.truthBias = truth.relativeErrorOfMean;
  return out;
}

} // namespace lambent
