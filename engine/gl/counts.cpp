#include "engine/gl/counts.h"

#include "engine/gl/pulse.h"
#include "engine/gl/ring.h"

namespace lambent::gl {

Counts& detail::countsSoFar() {
  thread_local Counts counts; // a thread draws in one context
  return counts;
}

const Counts& counts() { return detail::countsSoFar(); }

void drawArrays(GLenum mode, int count) {
  pulse();
  glDrawArrays(mode, 0, count);
  ++detail::countsSoFar().draws;
}

void drawFeedback(GLenum mode, const TransformFeedback& feedback, int instances) {
  pulse();
  glDrawTransformFeedbackInstanced(mode, feedback.name(), instances);
  ++detail::countsSoFar().draws;
}

void drawIndexed(const BufferSlice& draws, size_t first, size_t count) {
  pulse();
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, draws.buffer->name());
  glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                              reinterpret_cast<const void*>(uintptr_t(draws.offset + first * sizeof(IndexedDraw))),
                              GLsizei(count), sizeof(IndexedDraw));
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
  ++detail::countsSoFar().draws;
}

namespace {

/// The core profile wants a vertex array even for a draw without attributes. Names belong to a context, and making an
/// empty one costs nothing next to the draw, so nothing is kept.
void drawWithoutAttributes(GLenum mode, int count) {
  const VertexArray empty("no attributes");
  glBindVertexArray(empty.name());
  drawArrays(mode, count);
  glBindVertexArray(0);
}

} // namespace

void drawFullscreen() { drawWithoutAttributes(GL_TRIANGLES, 3); }
void drawPoints(int count) { drawWithoutAttributes(GL_POINTS, count); }
void dispatch(int groupsX, int groupsY, int groupsZ) {
  pulse();
  glDispatchCompute(GLuint(groupsX), GLuint(groupsY), GLuint(groupsZ));
  ++detail::countsSoFar().draws;
}

void finishToMeasure() { glFinish(); }

} // namespace lambent::gl
