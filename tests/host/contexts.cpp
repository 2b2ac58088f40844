#include "contexts.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glx.h>

namespace lambent::test {

namespace {

template <class Host> std::unique_ptr<HostContext> orNull(std::unique_ptr<Host> host) {
  if (!host->made()) return nullptr;
  return host;
}

class Egl : public HostContext {
 public:
  /// Null context where the display has none.
  Egl(EGLDisplay display, EGLenum api, EGLContext shared, EGLint profile = EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT)
      : display_(display), api_(api) {
    const EGLint core[] = {
        EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK, profile, EGL_NONE};
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

std::unique_ptr<HostContext> byEgl(EGLenum api, EGLint profile = EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT) {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return nullptr;
  return orNull(std::make_unique<Egl>(display, api, EGL_NO_CONTEXT, profile));
}

/// A window that is never shown, as a toolkit would make it.
class Glx : public HostContext {
 public:
  Glx(Display* display, GLXContext shared) : display_(display), owner_(shared == nullptr) {
    const int wanted[] = {GLX_DRAWABLE_TYPE, GLX_WINDOW_BIT, GLX_RENDER_TYPE, GLX_RGBA_BIT, GLX_DOUBLEBUFFER, 1, 0};
    int count = 0;
    GLXFBConfig* const configs = glXChooseFBConfig(display, DefaultScreen(display), wanted, &count);
    if (!configs || count == 0) return;
    XVisualInfo* const visual = glXGetVisualFromFBConfig(display, configs[0]);
    XSetWindowAttributes attributes = {};
    const Window root = RootWindow(display, visual->screen);
    attributes.colormap = XCreateColormap(display, root, visual->visual, AllocNone);
    window_ = XCreateWindow(display, root, 0, 0, 64, 48, 0, visual->depth, InputOutput, visual->visual,
                            CWColormap | CWBorderPixel, &attributes);
    XFree(visual);
    const int core[] = {
        GLX_CONTEXT_MAJOR_VERSION_ARB,    4, GLX_CONTEXT_MINOR_VERSION_ARB, 5, GLX_CONTEXT_PROFILE_MASK_ARB,
        GLX_CONTEXT_CORE_PROFILE_BIT_ARB, 0};
    const auto create = reinterpret_cast<PFNGLXCREATECONTEXTATTRIBSARBPROC>(
        glXGetProcAddressARB(reinterpret_cast<const GLubyte*>("glXCreateContextAttribsARB")));
    XSetErrorHandler([](Display*, XErrorEvent*) { return 0; }); // a context that is refused ends no program
    context_ = create(display, configs[0], shared, True, core);
    XFree(configs);
  }
  ~Glx() override {
    if (glXGetCurrentContext() == context_) release();
    if (context_) glXDestroyContext(display_, context_);
    if (window_) XDestroyWindow(display_, window_);
    if (owner_) XCloseDisplay(display_);
  }
  bool made() const { return context_ != nullptr; }
  void makeCurrent() override { glXMakeCurrent(display_, window_, context_); }
  void release() override { glXMakeCurrent(display_, 0, nullptr); }
  std::unique_ptr<HostContext> sharing() override { return std::make_unique<Glx>(display_, context_); }

 private:
  Display* display_;
  bool owner_; // of the display
  Window window_ = 0;
  GLXContext context_ = nullptr;
};

} // namespace

std::unique_ptr<HostContext> eglHost() { return byEgl(EGL_OPENGL_API); }
std::unique_ptr<HostContext> compatibilityHost() {
  return byEgl(EGL_OPENGL_API, EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT);
}
std::unique_ptr<HostContext> embeddedHost() { return byEgl(EGL_OPENGL_ES_API); }

std::unique_ptr<HostContext> glxHost() {
  XInitThreads();
  Display* const display = XOpenDisplay(nullptr);
  return display ? orNull(std::make_unique<Glx>(display, nullptr)) : nullptr;
}

} // namespace lambent::test
