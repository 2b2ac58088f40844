#include "engine/platform/context_setup.h"

#include "engine/gl/context.h"
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
  gl::requireContext();
  glEnable(GL_DEBUG_OUTPUT);
  if (debug == DebugOutput::AtOnce) glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(onDebugMessage, nullptr);
  gl::setConventions();
}

} // namespace lambent
