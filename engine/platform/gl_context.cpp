#include "engine/platform/gl_context.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/resources.h"
#include "engine/gl/context.h"
#include "engine/gl/state_guard.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <atomic>
#include <cstdlib>

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

std::vector<EGLDeviceEXT> eglDevices() {
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))
    return {};
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> devices(static_cast<size_t>(count));
  if (!eglQueryDevicesEXT(count, devices.data(), &count)) return {};
  devices.resize(size_t(count));
  return devices;
}

DeviceDescription describe(EGLDeviceEXT device) {
  const char* listed = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
  const std::string extensions = listed ? " " + std::string(listed) + " " : "";
  const auto has = [&](const char* name) {
    return extensions.find(" " + std::string(name) + " ") != std::string::npos;
  };
  if (has("EGL_MESA_device_software")) return {"software", true};
  if (has("EGL_EXT_device_drm"))
    if (const char* file = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT)) return {file, false};
  return {has("EGL_NV_device_cuda") ? "GPU by NVIDIA" : "GPU", false};
}

/// A current context on `display`, or nothing with the reason in `why`. The display stays as it is for those who use it
/// next to us.
EGLContext contextOn(EGLDisplay display, Drawn drawn, std::string& why) {
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
  else if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
    why = "context cannot be made current";
  else if (const std::string renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
           drawn != Drawn::ByAny && gl::drawnByCpu(renderer) != (drawn == Drawn::ByCpu))
    why = (drawn == Drawn::ByCpu ? "not software: " : "only software: ") + renderer;
  else
    return context;
  if (context != EGL_NO_CONTEXT) {
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
  }
  return EGL_NO_CONTEXT;
}

EGLDisplay displayOf(int device, const std::vector<EGLDeviceEXT>& devices) {
  if (device != DeviceAttempt::kSurfaceless)
    return epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")
               ? eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[size_t(device)], nullptr)
               : EGL_NO_DISPLAY;
  return epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")
             ? eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)
             : EGL_NO_DISPLAY;
}

std::atomic<uint64_t> debugErrors{0};

/// To standard error: what programs print is for others to read.
spdlog::logger& driverLog() {
  static spdlog::logger logger("OpenGL", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  return logger;
}

void APIENTRY onDebugMessage(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei, const GLchar* text,
                             const void*) {
  // Our own group markers come back as notifications; compilers' messages reach the user with the program's log.
  if (source == GL_DEBUG_SOURCE_APPLICATION || source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
  if (severity == GL_DEBUG_SEVERITY_HIGH || type == GL_DEBUG_TYPE_ERROR) {
    ++debugErrors;
    driverLog().error("OpenGL {:#x}: {}", id, text);
  } else if (severity == GL_DEBUG_SEVERITY_MEDIUM) {
    driverLog().debug("OpenGL {:#x}: {}", id, text);
  }
}

/// Checks version and limits (RunError), installs the debug callback, and sets the conventions that every pass relies
/// on.
void setUpContext(DebugOutput debug) {
  gl::requireContext();
  glEnable(GL_DEBUG_OUTPUT);
  if (debug == DebugOutput::AtOnce) glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(onDebugMessage, nullptr);
  gl::setConventions();
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

/// Beside those that draw, where the CPU does: they compile, and write caches.
constexpr int kThreadsOfDriver = 3;

} // namespace

struct GlContext::State {
  std::string route;
  EglRoute egl;
  GLFWwindow* window = nullptr;

  ~State() {
    if (egl.context != EGL_NO_CONTEXT) {
      if (eglGetCurrentContext() == egl.context)
        eglMakeCurrent(egl.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(egl.display, egl.context); // its display may have other users, so it is not terminated
    }
    if (window) {
      glfwDestroyWindow(window);
      glfwTerminate();
    }
  }
};

uint64_t glDebugErrors() { return debugErrors; }

GlContext::GlContext(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;

std::vector<DeviceDescription> GlContext::devices() {
  std::vector<DeviceDescription> descriptions;
  for (const EGLDeviceEXT device : eglDevices()) descriptions.push_back(describe(device));
  return descriptions;
}

GlContext GlContext::headless(DebugOutput debug) {
  requireResources(kThreadsOfDriver + threadCount());
  const std::vector<EGLDeviceEXT> devices = eglDevices();
  const std::vector<DeviceDescription> descriptions = GlContext::devices();
  const DeviceWish wish = deviceWish(std::getenv("LAMBENT_DEVICE"), std::getenv("LIBGL_ALWAYS_SOFTWARE"));
  auto state = std::make_unique<State>();
  std::vector<std::string> reasons;
  for (const DeviceAttempt& attempt : deviceAttempts(descriptions, wish)) {
    const bool surfaceless = attempt.device == DeviceAttempt::kSurfaceless;
    state->route = surfaceless ? "EGL surfaceless" : "EGL device " + std::to_string(attempt.device);
    state->egl.display = displayOf(attempt.device, devices);
    std::string why;
    state->egl.context = contextOn(state->egl.display, attempt.drawn, why);
    if (state->egl.context != EGL_NO_CONTEXT) {
      setUpContext(debug);
      return GlContext(std::move(state));
    }
    reasons.push_back(state->route + ": " + why);
  }
  throw RunError(noContextMessage(descriptions, wish, reasons));
}

GlContext GlContext::window(const std::string& title, int width, int height, bool asIs, DebugOutput debug) {
  requireResources(kThreadsOfDriver + threadCount());
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
  if (GLFWmonitor* monitor = asIs ? nullptr : glfwGetPrimaryMonitor())
    if (const GLFWvidmode* mode = glfwGetVideoMode(monitor))
      width = std::min(width, mode->width), height = std::min(height, mode->height);
  state->window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!state->window) {
    glfwTerminate();
    throw RunError("no window with OpenGL 4.5 (" + lastError +
                   "); install the GPU's OpenGL driver, or Mesa's, libgl1-mesa-dri, which draws on any machine");
  }
  glfwMakeContextCurrent(state->window);
  setUpContext(debug);
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
