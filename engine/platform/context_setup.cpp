#include "engine/platform/context_setup.h"

#include "engine/core/error.h"
#include "engine/gl/state_guard.h"

#include <epoxy/gl.h>
#include <spdlog/spdlog.h>

#include <atomic>

namespace lambent {

namespace {

std::atomic<uint64_t> debugErrors{0};

void APIENTRY onDebugMessage(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei, const GLchar* text,
                             const void*) {
  // Our own group markers come back as notifications; compilers' messages reach the user with the program's log.
  if (source == GL_DEBUG_SOURCE_APPLICATION || source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
  if (severity == GL_DEBUG_SEVERITY_HIGH || type == GL_DEBUG_TYPE_ERROR) {
    ++debugErrors;
    spdlog::error("OpenGL {:#x}: {}", id, text);
  } else if (severity == GL_DEBUG_SEVERITY_MEDIUM) {
    spdlog::debug("OpenGL {:#x}: {}", id, text);
  }
}

} // namespace

uint64_t glDebugErrors() { return debugErrors; }

void setUpContext(DebugOutput debug) {
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

  glEnable(GL_DEBUG_OUTPUT);
  if (debug == DebugOutput::AtOnce) glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(onDebugMessage, nullptr);
  gl::setConventions();
}

} // namespace lambent
