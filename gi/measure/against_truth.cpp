#include "gi/measure/against_truth.h"

#include <cmath>

namespace lambent {

std::optional<double> AgainstTruth::pictureRmse() const {
  if (!known()) return {};
  return std::sqrt(error.rmse * error.rmse - truthRmse * truthRmse);
}

std::optional<double> pathTracingMs(double relMse, double ofTruth, double truthMs) {
  if (!(ofTruth > 0) || !(relMse > 2 * ofTruth)) return {};
  return truthMs * ofTruth / (relMse - ofTruth);
}

AgainstTruth againstTruth(const Image& picture, const ReferencePicture& truth) {
  AgainstTruth out{.error = pictureError(picture, truth.mean)};
  out.truthRmse = truth.relativeError * out.error.meanTruth;
  out.truthRelMse = expectedRelMse(truth.mean, truth.error);
  out.truthBias = truth.relativeErrorOfMean;
  return out;
}

} // namespace lambent
