// Which EGL device draws without a display: a choice over descriptions, so that it is tested without the devices.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lambent {

/// An EGL device as it describes itself.
struct DeviceDescription {
  std::string name;
  bool software = false; // no device behind it: the CPU draws
};

/// What the user asks for by environment variables.
struct DeviceWish {
  std::optional<int> device = {}; // LAMBENT_DEVICE=N
  bool software = false;          // LAMBENT_DEVICE=software
  bool softwareMesa = false;      // LIBGL_ALWAYS_SOFTWARE=1: Mesa's own, also for its drivers that draw through another
};
/// Null: not set. Throws InputError for what is neither a number nor "software".
DeviceWish deviceWish(const char* lambentDevice, const char* libglAlwaysSoftware);

/// Who may draw in a context: whatever it is, a GPU, or the CPU.
enum class Drawn { ByAny, ByGpu, ByCpu };

/// One way to a context. Tried in turn until one gives OpenGL 4.5 that is drawn by whom it should be.
struct DeviceAttempt {
  static constexpr int kSurfaceless = -1; // Mesa's platform without devices: it takes the first that it finds
  int device = kSurfaceless;
  Drawn drawn = Drawn::ByAny;
  bool operator==(const DeviceAttempt&) const = default;
};

/// GPUs first. Software when it is asked for or all that there is, never because a GPU failed: an image would then
/// take a hundred times as long, and nobody would know why. Throws InputError when the wish is for a device that is not
/// there.
std::vector<DeviceAttempt> deviceAttempts(std::span<const DeviceDescription> devices, const DeviceWish& wish);

/// What to tell when every attempt failed: one line, with the cure. `reasons` are those of the attempts.
std::string noContextMessage(std::span<const DeviceDescription> devices, const DeviceWish& wish,
                             std::span<const std::string> reasons);

} // namespace lambent
