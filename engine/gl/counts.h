// What was asked of GL: draws, and the places where the CPU stands still for the GPU. Everything above engine/gl draws,
// reads back and waits through the functions of this folder (tools/check_layers), so that nothing is missed.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <cstdint>

namespace lambent::gl {

struct BufferSlice;
class TransformFeedback;

/// Calls so far in this process. A read-back waits too, but counts only as what it is.
struct Counts {
  uint64_t draws = 0;     // draw calls; those of a multi-draw are one
  uint64_t waits = 0;     // for a query's result or a fence that were not known to be there
  uint64_t readBacks = 0; // copies from the GPU's memory

  Counts operator-(const Counts& since) const {
    return {draws - since.draws, waits - since.waits, readBacks - since.readBacks};
  }
};
const Counts& counts();

/// Draws since it was made.
class DrawCount {
 public:
  uint64_t operator()() const { return counts().draws - before_; }

 private:
  uint64_t before_ = counts().draws;
};

namespace detail {
Counts& countsSoFar(); // contexts are used from one thread
} // namespace detail

void drawArrays(GLenum mode, int count);
/// Draws as many vertices as were last captured into `feedback`.
void drawFeedback(GLenum mode, const TransformFeedback& feedback, int instances = 1);

/// Triangles of 32-bit indices of the bound vertex array, as GL reads them from a buffer.
struct IndexedDraw {
  uint32_t count = 0, instances = 1, firstIndex = 0;
  int32_t baseVertex = 0;
  uint32_t baseInstance = 0;
};
static_assert(sizeof(IndexedDraw) == 20);
/// Draws in one call `count` of the IndexedDraws that a slice holds, from `first` on, in their order.
void drawIndexed(const BufferSlice& draws, size_t first, size_t count);

/// Draws one triangle over the viewport; the bound program makes its corners from gl_VertexID
/// (shaders/fullscreen.vert).
void drawFullscreen();
/// Draws points that the bound program makes from gl_VertexID.
void drawPoints(int count);
/// Runs so many groups of the bound compute program; counted as a draw.
void dispatch(int groupsX, int groupsY = 1, int groupsZ = 1);

/// Waits until the GPU has done all that it was asked for, so that a clock on the CPU measures it. For measuring, and
/// once for the watch over a first picture: no other frame does this, so it is not counted.
void finishToMeasure();

} // namespace lambent::gl
