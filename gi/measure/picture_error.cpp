#include "gi/measure/picture_error.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>

namespace lambent {

PictureError pictureError(const Image& picture, const Image& truth, const Image& mask) {
  CHECK_EQ(picture.width, truth.width);
  CHECK_EQ(picture.height, truth.height);
  PictureError out;
  double squares = 0, relative = 0, difference = 0, sum = 0;
  for (size_t i = 0; i < truth.pixels.size(); ++i) {
    if (!mask.pixels.empty() && !(maxComponent(mask.pixels[i]) > 0)) continue;
    if (!isFinite(picture.pixels[i]) || !isFinite(truth.pixels[i])) {
      ++out.notFinite;
      continue;
    }
    ++out.pixels;
    for (int c = 0; c < 3; ++c) {
      const double b = truth.pixels[i][c], d = picture.pixels[i][c] - b;
      squares += d * d;
      relative += d * d / (b * b + 0.01);
      difference += d;
      sum += b;
      out.largest = std::max(out.largest, std::abs(d));
    }
  }
  const double n = 3 * double(std::max<size_t>(1, out.pixels));
  out.rmse = std::sqrt(squares / n);
  out.relMse = relative / n;
  out.bias = sum != 0 ? difference / sum : 0;
  out.meanTruth = sum / n;
  return out;
}

} // namespace lambent
