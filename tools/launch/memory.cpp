#include "tools/launch/memory.h"

#include "engine/core/error.h"
#include "engine/core/free_memory.h"

#include <cmath>

namespace lambent {

namespace {

/// Of a frame with all that the defaults ask for, and of what reads it back; measured: 346 (1920x1080 less 640x360,
/// llvmpipe).
constexpr size_t kBytesPerPixel = 400;

} // namespace

void checkPictureFits(const CameraView& camera) {
  const size_t pixels = size_t(camera.width) * size_t(camera.height), free = freeMemory();
  if (pixels <= free / kBytesPerPixel) return;
  const auto gib = [](size_t bytes) {
    return std::to_string((bytes >> 29) / 2) + (bytes >> 29 & 1 ? ".5" : "") + " GiB";
  };
  const double side = std::sqrt(double(free / kBytesPerPixel) / double(pixels));
  const CameraView fits = camera.scaled(float(0.95 * side));
  throw RunError("a picture of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                 " needs about " + gib(pixels * kBytesPerPixel) + " of memory, " + gib(free) + " are free (" +
                 std::to_string(fits.width) + "x" + std::to_string(fits.height) + " would fit: --size)");
}

} // namespace lambent
