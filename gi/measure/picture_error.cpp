#include "gi/measure/picture_error.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>

namespace lambent {

double rmse(const Image& picture, const Image& truth) {
  CHECK_EQ(picture.width, truth.width);
  CHECK_EQ(picture.height, truth.height);
  double squares = 0;
  for (size_t i = 0; i < truth.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double difference = double(picture.pixels[i][c]) - truth.pixels[i][c];
      squares += difference * difference;
    }
  return std::sqrt(squares / (3 * double(std::max<size_t>(1, truth.pixels.size()))));
}

double meanOf(const Image& picture) {
  double sum = 0;
  for (const vec3& pixel : picture.pixels)
    for (int c = 0; c < 3; ++c) sum += pixel[c];
  return sum / (3 * double(std::max<size_t>(1, picture.pixels.size())));
}

double rmseShare(const Image& picture, const Image& truth) {
  const double error = rmse(picture, truth);
  return error > 0 ? error / meanOf(truth) : 0;
}

} // namespace lambent
