#include "engine/platform/gl_context.h"

#include "engine/core/error.h"
#include "engine/platform/context_setup.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace lambent {

namespace {

constexpr EGLint kContextAttributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                         4,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         5,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_CONTEXT_OPENGL_DEBUG,
                                         EGL_TRUE,
                                         EGL_NONE};

struct EglRoute {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

/// A current surfaceless context on `display`, or nothing with the reason in `why`.
EGLContext contextOn(EGLDisplay display, std::string& why) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
    why = "no display";
    return EGL_NO_CONTEXT;
  }
  EGLContext context = EGL_NO_CONTEXT;
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context"))
    why = "no EGL_KHR_surfaceless_context";
  else if (!eglBindAPI(EGL_OPENGL_API))
    why = "no desktop OpenGL";
  else if ((context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kContextAttributes)) ==
           EGL_NO_CONTEXT)
    why = "no OpenGL 4.5 core context";
  else if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
    return context;
  else
    why = "context cannot be made current";
  if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  eglTerminate(display);
  return EGL_NO_CONTEXT;
}

std::string glText(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "unknown";
}

std::string glLimit(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return std::to_string(value);
}

} // namespace

struct GlContext::State {
  std::string route;
  EglRoute egl;
  GLFWwindow* window = nullptr;

  ~State() {
    if (egl.context != EGL_NO_CONTEXT) {
      eglMakeCurrent(egl.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(egl.display, egl.context);
      eglTerminate(egl.display);
    }
    if (window) {
      glfwDestroyWindow(window);
      glfwTerminate();
    }
  }
};

GlContext::GlContext(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;

GlContext GlContext::headless() {
  auto state = std::make_unique<State>();
  std::string whySurfaceless = "not offered", whyDevice = "not offered";

  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    state->egl.display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    state->egl.context = contextOn(state->egl.display, whySurfaceless);
    state->route = "EGL surfaceless";
  }
  if (state->egl.context == EGL_NO_CONTEXT && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    eglQueryDevicesEXT(16, devices, &count);
    for (EGLint i = 0; i < count && state->egl.context == EGL_NO_CONTEXT; ++i) {
      state->egl.display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
      state->egl.context = contextOn(state->egl.display, whyDevice);
      state->route = "EGL device " + std::to_string(i);
    }
  }
  if (state->egl.context == EGL_NO_CONTEXT)
    throw RunError("no OpenGL without a display (EGL surfaceless: " + whySurfaceless + "; EGL device: " + whyDevice +
                   "); installing Mesa's drivers, libegl-mesa0 and libgl1-mesa-dri, cures this");
  setUpContext();
  return GlContext(std::move(state));
}

GlContext GlContext::window(const std::string& title, int width, int height) {
  static std::string lastError;
  glfwSetErrorCallback([](int, const char* text) { lastError = text; });
  if (!glfwInit()) throw RunError("no window system (" + lastError + "); use the headless commands, or xvfb-run -a");
  auto state = std::make_unique<State>();
  state->route = "GLFW window";
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  state->window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!state->window) {
    glfwTerminate();
    throw RunError("no window with OpenGL 4.5 (" + lastError + ")");
  }
  glfwMakeContextCurrent(state->window);
  setUpContext();
  return GlContext(std::move(state));
}

void GlContext::makeCurrent() {
  if (state_->window)
    glfwMakeContextCurrent(state_->window);
  else if (!eglMakeCurrent(state_->egl.display, EGL_NO_SURFACE, EGL_NO_SURFACE, state_->egl.context))
    throw RunError("the OpenGL context cannot be made current on this thread");
}

GLFWwindow* GlContext::handle() const { return state_->window; }
bool GlContext::shouldClose() const { return state_->window && glfwWindowShouldClose(state_->window); }

void GlContext::poll() {
  if (state_->window) glfwPollEvents();
}

void GlContext::swap() {
  if (state_->window) glfwSwapBuffers(state_->window);
}

std::pair<int, int> GlContext::framebufferSize() const {
  int width = 0, height = 0;
  if (state_->window) glfwGetFramebufferSize(state_->window, &width, &height);
  return {width, height};
}

std::vector<std::pair<std::string, std::string>> GlContext::info() const {
  return {
      {"route", state_->route},
      {"vendor", glText(GL_VENDOR)},
      {"renderer", glText(GL_RENDERER)},
      {"version", glText(GL_VERSION)},
      {"shading language", glText(GL_SHADING_LANGUAGE_VERSION)},
      {"texture size", glLimit(GL_MAX_TEXTURE_SIZE)},
      {"array layers", glLimit(GL_MAX_ARRAY_TEXTURE_LAYERS)},
      {"uniform block bytes", glLimit(GL_MAX_UNIFORM_BLOCK_SIZE)},
  };
}

} // namespace lambent
