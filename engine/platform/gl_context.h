// An OpenGL 4.5 core context by one of two routes behind one type: a GLFW window, or EGL without any display.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

struct GLFWwindow;

namespace lambent {

class GlContext {
 public:
  /// EGL surfaceless, else the first EGL device that gives a context. Draw only into framebuffers of your own.
  /// Throws RunError with a cure when the machine has neither.
  static GlContext headless();
  /// A resizable window. Throws RunError when there is no display or no OpenGL 4.5.
  static GlContext window(const std::string& title, int width, int height);

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
