// Lambent in one context with another renderer: leaves all GL state as it found it.
#pragma once

#include <memory>

namespace lambent::gl {

/// What every pass takes for granted and none sets: clip space with the origin at the lower left and depth from 0 to 1,
/// seamless cubes, tightly packed pixels in memory of the CPU, and everything that the host may have switched on and
/// PipelineState does not know (logic operations, sample masks, clip distances, …) as a new context has it.
void setConventions();

/// Saves all state of the context that Lambent's passes set or depend on, sets the conventions, and puts everything
/// back at its end: program, vertex array, framebuffers, viewports and scissors, depth, stencil, blending, masks, clip
/// control, polygons, points, multisampling, pixel store and its buffers, texture units and samplers 0 to 9, uniform
/// buffers 0 to 3, shader storage buffer 0, indirect buffer, transform feedback (paused meanwhile if it runs), and the
/// one vertex attribute that is set. What it cannot save must have ended: queries, conditional rendering, and transform
/// feedback of the default object.
class StateGuard {
 public:
  StateGuard();
  ~StateGuard();
  StateGuard(const StateGuard&) = delete;
  StateGuard& operator=(const StateGuard&) = delete;

 private:
  struct Saved;
  std::unique_ptr<const Saved> saved_;
};

} // namespace lambent::gl
