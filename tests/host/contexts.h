// Contexts as hosts make them: without GLFW and without engine/platform.
#pragma once

#include <memory>

namespace lambent::test {

class HostContext {
 public:
  virtual ~HostContext() = default;
  virtual void makeCurrent() = 0;
  virtual void release() = 0;
  /// A second one that shares objects with it, current nowhere.
  virtual std::unique_ptr<HostContext> sharing() = 0;
};

/// OpenGL 4.5 core; null where this machine has no such window system.
std::unique_ptr<HostContext> eglHost();
std::unique_ptr<HostContext> glxHost();
/// OpenGL ES, which is too little.
std::unique_ptr<HostContext> compatibilityHost();
std::unique_ptr<HostContext> embeddedHost();

} // namespace lambent::test
