#include "gi/reference/state_file.h"

#include "engine/core/checked_file.h"
#include "engine/core/error.h"
#include "engine/view/scene_hash.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lambent {

namespace {

constexpr uint32_t kVersion = 2; // counts up when the file or the meaning of the sums (the sampling included) changes
const FileKind kKind{{'L', 'A', 'M', 'B', 'R', 'E', 'F', '\n'},
                     kVersion,
                     sizeof(PixelSums),
                     "the state of a reference",
                     "a file written by --state"};
static_assert(sizeof(PixelSums) == 15 * sizeof(double));

void add(Hash& hash, const LightView& light) {
  hash.value(light.type);
  hash.value(light.position);
  hash.value(light.direction);
  hash.value(light.intensity);
  hash.value(light.range);
  hash.value(light.innerConeCos);
  hash.value(light.outerConeCos);
  hash.value(light.angularRadius);
}

/// Sums that so many samples may have, none below zero: the square of a sum is at least the sum of squares, and at most
/// the samples times that. Pictures hold their means in single precision.
bool possible(const PixelSums& p, uint32_t samples) {
  constexpr double kRounding = 1 + 1e-6, kMostMean = double(std::numeric_limits<float>::max()) / 4;
  const auto holds = [&](double sum, double squares) {
    return sum >= 0 && sum <= samples * kMostMean && squares >= 0 && // comparisons are false for NaN
           sum * sum <= samples * squares * kRounding && squares <= sum * sum * kRounding;
  };
  for (int c = 0; c < 3; ++c)
    if (!holds(p.direct[c], p.directSquares[c]) || !holds(p.indirect[c], p.indirectSquares[c]) ||
        !(p.product[c] >= 0 && p.product[c] * p.product[c] <= p.directSquares[c] * p.indirectSquares[c] * kRounding))
      return false;
  return true;
}

} // namespace

uint64_t referenceKey(const SceneView& view, const ReferenceInputs& in) {
  Hash hash(kVersion);
  addGeometry(hash, view, in.glossy != nullptr, in.normalMaps != nullptr);
  for (const LightView& light : view.lights) add(hash, light);
  for (const float number : view.sky.numbers()) hash.value(number);
  hash.bytes(&in.camera.worldFromView, sizeof in.camera.worldFromView);
  hash.value(in.camera.fovY);
  hash.value(in.camera.orthoHalfHeight);
  hash.value(in.camera.near);
  hash.value(in.camera.width);
  hash.value(in.camera.height);
  hash.value(in.bounces);
  hash.value(in.clamp);
  hash.value(in.seed);
  if (in.glossy) hash.value(true);
  if (in.normalMaps) hash.value('n');
  if (in.mixes) hash.value('m');
  return hash.result();
}

void saveReference(const std::filesystem::path& file, const ReferenceSums& sums, uint64_t key) {
  writeChecked(file, kKind, key, [&](CheckedWriter& writer) {
    writer.value(sums.width);
    writer.value(sums.height);
    writer.value(sums.samples);
    writer.values(std::span(sums.pixels));
  });
}

uint32_t samplesIn(const std::filesystem::path& file, const ReferenceInputs& in, uint64_t key) {
  try {
    CheckedReader reader(file, kKind);
    int width = 0, height = 0;
    uint32_t samples = 0;
    reader.value(width);
    reader.value(height);
    reader.value(samples);
    const bool same = reader.key() == key && width == in.camera.width && height == in.camera.height;
    return same && samples <= ReferenceSums::kMostSamples ? samples : 0;
  } catch (const InputError&) { // none, or something else
    return 0;
  }
}

ReferenceSums loadReference(const std::filesystem::path& file, const ReferenceInputs& in, uint64_t key) {
  CheckedReader reader(file, kKind);
  int width = 0, height = 0;
  reader.value(width);
  reader.value(height);
  if (width < 1 || height < 1) reader.damaged();
  if (width != in.camera.width || height != in.camera.height)
    reader.refuse("holds an image of " + std::to_string(width) + "x" + std::to_string(height) + " (this run's is " +
                  std::to_string(in.camera.width) + "x" + std::to_string(in.camera.height) + ")");
  if (reader.key() != key)
    reader.refuse(
        "belongs to another picture (same scene, lights, camera, bounces, clamp, seed and kind of buffer expected)");
  ReferenceSums sums(width, height);
  reader.value(sums.samples);
  reader.values(std::span(sums.pixels));
  reader.end();
  const auto right = [&](const PixelSums& p) { return possible(p, sums.samples); };
  if (sums.samples > ReferenceSums::kMostSamples || !std::all_of(sums.pixels.begin(), sums.pixels.end(), right))
    reader.damaged();
  return sums;
}

} // namespace lambent
