#include "contexts.h"

#include <GL/glx.h>

namespace lambent::test {

namespace {

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

std::unique_ptr<HostContext> glxHost() {
  XInitThreads();
  Display* const display = XOpenDisplay(nullptr);
  if (!display) return nullptr;
  auto host = std::make_unique<Glx>(display, nullptr);
  if (!host->made()) return nullptr;
  return host;
}

} // namespace lambent::test
