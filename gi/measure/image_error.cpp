#include "gi/measure/image_error.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace lambent {

namespace {

/// Of relative squared errors: what counts as dark.
double relative(double square, double truth) { return square / (truth * truth + 0.01); }

} // namespace

ImageError imageError(const Image& picture, const Image& truth, const Image& mask) {
  CHECK_EQ(picture.width, truth.width);
  CHECK_EQ(picture.height, truth.height);
  ImageError out;
  double squares = 0, relativeSquares = 0, difference = 0, sum = 0;
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
      relativeSquares += relative(d * d, b);
      difference += d;
      sum += b;
      out.largest = std::max(out.largest, std::abs(d));
    }
  }
  const double n = 3 * double(std::max<size_t>(1, out.pixels));
  out.rmse = std::sqrt(squares / n);
  out.relMse = relativeSquares / n;
  out.bias = sum != 0 ? difference / sum : 0;
  out.meanTruth = sum / n;
  return out;
}

double expectedRelMse(const Image& mean, const Image& standardError) {
  CHECK_EQ(mean.width, standardError.width);
  CHECK_EQ(mean.height, standardError.height);
  double sum = 0;
  size_t values = 0;
  for (size_t i = 0; i < mean.pixels.size(); ++i) {
    if (!isFinite(mean.pixels[i]) || !isFinite(standardError.pixels[i])) continue;
    for (int c = 0; c < 3; ++c) sum += relative(std::pow(standardError.pixels[i][c], 2), mean.pixels[i][c]);
    values += 3;
  }
  return values ? sum / double(values) : 0;
}

Image allButBrightest(const Image& truth, double share) {
  std::vector<uint32_t> order(truth.pixels.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return luminance(truth.pixels[a]) > luminance(truth.pixels[b]); });
  Image mask(truth.width, truth.height, vec3(1));
  for (size_t i = 0; i < size_t(share * double(order.size())); ++i) mask.pixels[order[i]] = vec3(0);
  return mask;
}

double blocksWithin(const Image& picture, const Image& truth, int size, double tolerance) {
  CHECK_EQ(picture.width, truth.width);
  CHECK_EQ(picture.height, truth.height);
  size_t blocks = 0, within = 0;
  for (int y0 = 0; y0 + size <= truth.height; y0 += size)
    for (int x0 = 0; x0 + size <= truth.width; x0 += size) {
      double sum = 0, wanted = 0;
      for (int y = y0; y < y0 + size; ++y)
        for (int x = x0; x < x0 + size; ++x) {
          sum += double(luminance(picture.at(x, y)));
          wanted += double(luminance(truth.at(x, y)));
        }
      ++blocks;
      within += std::abs(sum - wanted) <= tolerance * wanted;
    }
  return blocks ? double(within) / double(blocks) : 1;
}

std::optional<double> AgainstTruth::imageRmse() const {
  if (!known()) return {};
  return std::sqrt(error.rmse * error.rmse - truthRmse * truthRmse);
}

std::optional<double> pathTracingMs(double relMse, double ofTruth, double truthMs) {
  if (!(ofTruth > 0) || !(relMse > 2 * ofTruth)) return {};
  return truthMs * ofTruth / (relMse - ofTruth);
}

AgainstTruth againstTruth(const Image& picture, const ReferenceImage& truth) {
  AgainstTruth out{.error = imageError(picture, truth.mean)};
  out.truthRmse = truth.relativeError * out.error.meanTruth;
  out.truthRelMse = expectedRelMse(truth.mean, truth.error);
  out.truthBias = truth.relativeErrorOfMean;
  return out;
}

} // namespace lambent
