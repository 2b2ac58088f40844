#include "contexts.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

namespace lambent::test {

namespace {

class Egl : public HostContext {
 public:
  /// Null context where the display has none.
  Egl(EGLDisplay display, EGLenum api, EGLContext shared) : display_(display), api_(api) {
    const EGLint core[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLint embedded[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
    eglBindAPI(api);
    context_ = eglCreateContext(display, EGL_NO_CONFIG_KHR, shared, api == EGL_OPENGL_API ? core : embedded);
  }
  ~Egl() override {
    eglBindAPI(api_);
    if (eglGetCurrentContext() == context_) release();
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  }
  bool made() const { return context_ != EGL_NO_CONTEXT; }
  void makeCurrent() override {
    eglBindAPI(api_);
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }
  void release() override {
    eglBindAPI(api_);
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  std::unique_ptr<HostContext> sharing() override { return std::make_unique<Egl>(display_, api_, context_); }

 private:
  EGLDisplay display_;
  EGLenum api_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

std::unique_ptr<HostContext> made(EGLenum api) {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return nullptr;
  auto host = std::make_unique<Egl>(display, api, EGL_NO_CONTEXT);
  if (!host->made()) return nullptr;
  return host;
}

} // namespace

std::unique_ptr<HostContext> eglHost() { return made(EGL_OPENGL_API); }
std::unique_ptr<HostContext> embeddedHost() { return made(EGL_OPENGL_ES_API); }

} // namespace lambent::test
