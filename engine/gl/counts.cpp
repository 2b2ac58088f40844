#include "engine/gl/counts.h"

#include "engine/gl/objects.h"

namespace lambent::gl {

Counts& detail::countsSoFar() {
  static Counts counts;
  return counts;
}

const Counts& counts() { return detail::countsSoFar(); }

void drawArrays(GLenum mode, int count) {
  glDrawArrays(mode, 0, count);
  ++detail::countsSoFar().draws;
}

void drawFeedback(GLenum mode, const TransformFeedback& feedback, int instances) {
  glDrawTransformFeedbackInstanced(mode, feedback.name(), instances);
  ++detail::countsSoFar().draws;
}

void drawIndexed(const IndexedDraw& draw) {
  glDrawElementsInstancedBaseVertexBaseInstance(
      GL_TRIANGLES, GLsizei(draw.count), GL_UNSIGNED_INT,
      reinterpret_cast<const void*>(uintptr_t(draw.firstIndex) * sizeof(uint32_t)), GLsizei(draw.instances),
      draw.baseVertex, draw.baseInstance);
  ++detail::countsSoFar().draws;
}

void drawFullscreen() {
  // The core profile wants a vertex array even for a draw without attributes. Names belong to a context, and making an
  // empty one costs nothing next to the draw, so nothing is kept.
  const VertexArray empty("fullscreen");
  glBindVertexArray(empty.name());
  drawArrays(GL_TRIANGLES, 3);
  glBindVertexArray(0);
}

void finishToMeasure() { glFinish(); }

} // namespace lambent::gl
