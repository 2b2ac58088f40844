// An OpenGL 4.5 core context by one of two routes behind one type: a GLFW window, or EGL without any display.
#pragma once

#include "engine/platform/device_choice.h"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

struct GLFWwindow;

namespace lambent {

/// When the driver sends its messages: as it likes, perhaps on a thread of its own; or before the call that it is
/// about returns, which keeps drivers from running ahead.
enum class DebugOutput { Asynchronous, AtOnce };

class GlContext {
 public:
  /// On an EGL device, GPUs first, else on Mesa's surfaceless platform (see device_choice.h). Draw only into
  /// framebuffers of your own. Throws RunError with a cure when nothing gives a context.
  static GlContext headless(DebugOutput debug = DebugOutput::Asynchronous);
  /// A resizable window, no larger than the monitor unless `asIs`. Throws RunError when there is no display or no OpenGL
  /// 4.5.
  static GlContext window(const std::string& title, int width, int height, bool asIs,
                          DebugOutput debug = DebugOutput::Asynchronous);
  /// EGL devices in the order of their numbers.
  static std::vector<DeviceDescription> devices();

  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  void makeCurrent();

  // Window only; null, or without effect, when headless.
  GLFWwindow* handle() const;
  bool shouldClose() const;
  void poll();
  void swap();
  /// Pixels of the default framebuffer; 0 × 0 when headless.
  std::pair<int, int> framebufferSize() const;

  /// Name and value of what this context is: route, vendor, renderer, version, limits that matter here.
  std::vector<std::pair<std::string, std::string>> info() const;

 private:
  struct State;
  explicit GlContext(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// High-severity messages of the driver since the program started; each was logged. 0 in a correct program.
uint64_t glDebugErrors();

} // namespace lambent
