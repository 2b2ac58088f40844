#include "engine/gl/context.h"

#include "engine/core/error.h"

#include <dlfcn.h>
#include <epoxy/gl.h>

namespace lambent::gl {

namespace {

/// Asked of the libraries that are here already, for without one of them nothing can be current; epoxy would end the
/// program.
bool contextIsCurrent() {
  struct Library {
    const char *file, *function;
  };
  constexpr Library kLibraries[] = {{"libGLX.so.0", "glXGetCurrentContext"},
                                    {"libGL.so.1", "glXGetCurrentContext"},
                                    {"libEGL.so.1", "eglGetCurrentContext"}};
  for (const Library& library : kLibraries)
    if (void* const loaded = dlopen(library.file, RTLD_LAZY | RTLD_NOLOAD)) {
      const auto current = reinterpret_cast<void* (*)()>(dlsym(loaded, library.function));
      const bool found = current && current();
      dlclose(loaded); // its user keeps it
      if (found) return true;
    }
  return false;
}

} // namespace

void requireContext() {
  if (!contextIsCurrent())
    throw RunError("no OpenGL context is current on this thread (make the host's current before it calls)");
  if (!epoxy_is_desktop_gl()) throw RunError("the current context is one of OpenGL ES (OpenGL 4.5 is needed)");
  const int version = epoxy_gl_version();
  if (version < 45)
    throw RunError("OpenGL " + std::to_string(version / 10) + "." + std::to_string(version % 10) +
                   " is too old (4.5 is needed; Mesa's llvmpipe offers it on any machine: install libgl1-mesa-dri)");
  GLint uniformBlockBytes = 0, layers = 0;
  glGetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &uniformBlockBytes);
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
  if (uniformBlockBytes < 65536)
    throw RunError("uniform blocks hold only " + std::to_string(uniformBlockBytes) + " bytes here (65536 are needed)");
  if (layers < 2048)
    throw RunError("array textures have only " + std::to_string(layers) + " layers here (2048 are needed)");
}

bool drawnByCpu(const std::string& renderer) {
  // A driver on top of a CPU's Vulkan names that one in brackets.
  for (const char* name : {"llvmpipe", "softpipe", "lavapipe", "swrast", "SWR", "SwiftShader", "Software Rasterizer"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

bool drawnByCpu() { return drawnByCpu(reinterpret_cast<const char*>(glGetString(GL_RENDERER))); }

} // namespace lambent::gl
