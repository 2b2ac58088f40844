#include "tools/launch/memory.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace lambent {

namespace {

constexpr size_t kUnknown = std::numeric_limits<size_t>::max();
/// Of a frame with all that the defaults ask for, and of what reads it back; measured: 346 (1920x1080 less 640x360,
/// llvmpipe).
constexpr size_t kBytesPerPixel = 400;

/// The number that a file begins with.
size_t numberIn(const char* file) {
  size_t value = 0;
  return std::ifstream(file) >> value ? value : kUnknown;
}

} // namespace

size_t freeMemory() {
  size_t free = kUnknown;
  std::ifstream all("/proc/meminfo");
  for (std::string name, unit; free == kUnknown && all >> name;) {
    size_t kib = 0;
    if (!(all >> kib)) break;
    std::getline(all, unit);
    if (name == "MemAvailable:") free = kib << 10;
  }
  const char* limits[][2] = {
      {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"},
      {"/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"}};
  for (const auto& [most, now] : limits) {
    const size_t limit = numberIn(most), used = numberIn(now);
    if (limit != kUnknown && used != kUnknown) free = std::min(free, limit - std::min(limit, used));
  }
  return free;
}

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
