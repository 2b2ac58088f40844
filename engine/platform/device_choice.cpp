#include "engine/platform/device_choice.h"

#include "engine/core/error.h"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace lambent {

namespace {

bool isSoftware(const DeviceDescription& device) { return device.software; }

std::string listOf(std::span<const DeviceDescription> devices) {
  std::string text;
  for (size_t i = 0; i < devices.size(); ++i) text += (i ? ", " : "") + std::to_string(i) + " = " + devices[i].name;
  return text.empty() ? "no devices" : text;
}

} // namespace

DeviceWish deviceWish(const char* lambentDevice, const char* libglAlwaysSoftware) {
  DeviceWish wish;
  if (libglAlwaysSoftware) {
    const std::string_view value = libglAlwaysSoftware;
    wish.softwareMesa = value == "1" || value == "true" || value == "yes" || value == "y";
  }
  if (!lambentDevice || !*lambentDevice) return wish;
  const char* end = lambentDevice + std::strlen(lambentDevice);
  int number = 0;
  if (std::string_view(lambentDevice) == "software")
    wish.software = true;
  else if (const auto [last, error] = std::from_chars(lambentDevice, end, number);
           error == std::errc() && last == end && number >= 0)
    wish.device = number;
  else
    throw InputError("LAMBENT_DEVICE=" + std::string(lambentDevice),
                     "is neither \"software\" nor the number of a device (lambent doctor lists them)");
  return wish;
}

std::vector<DeviceAttempt> deviceAttempts(std::span<const DeviceDescription> devices, const DeviceWish& wish) {
  if (wish.device) {
    if (size_t(*wish.device) >= devices.size())
      throw InputError("LAMBENT_DEVICE=" + std::to_string(*wish.device), "no such device (" + listOf(devices) + ")");
    return {{*wish.device, Drawn::ByAny}};
  }
  std::vector<DeviceAttempt> attempts;
  const auto add = [&](bool software, Drawn drawn) {
    for (size_t i = 0; i < devices.size(); ++i)
      if (devices[i].software == software) attempts.push_back({int(i), drawn});
  };
  // Without devices this platform is the way for software too, and the only one that Mesa's drivers on top of Vulkan
  // were seen to take.
  const auto addSurfaceless = [&](Drawn drawn) { attempts.push_back({DeviceAttempt::kSurfaceless, drawn}); };
  if (wish.softwareMesa) {
    addSurfaceless(Drawn::ByCpu);
    add(true, Drawn::ByCpu);
  } else if (wish.software) {
    add(true, Drawn::ByCpu);
    addSurfaceless(Drawn::ByCpu);
  } else if (std::all_of(devices.begin(), devices.end(), isSoftware)) {
    addSurfaceless(Drawn::ByAny);
    add(true, Drawn::ByAny);
  } else {
    add(false, Drawn::ByGpu);
    addSurfaceless(Drawn::ByGpu);
  }
  return attempts;
}

std::string noContextMessage(std::span<const DeviceDescription> devices, const DeviceWish& wish,
                             std::span<const std::string> reasons) {
  std::string text = "no OpenGL 4.5 without a display (";
  for (size_t i = 0; i < reasons.size(); ++i) text += (i ? "; " : "") + reasons[i];
  text += ")";
  const bool gpu = !std::all_of(devices.begin(), devices.end(), isSoftware);
  if (gpu && !wish.device && !wish.software && !wish.softwareMesa)
    return text + "; install the GPU's OpenGL driver, or ask for slow software rendering with LAMBENT_DEVICE=software";
  if (wish.device) return text + "; LAMBENT_DEVICE may name another: " + listOf(devices);
  return text + "; installing Mesa's drivers, libegl-mesa0 and libgl1-mesa-dri, cures this";
}

} // namespace lambent
