// Lambent in one context with another renderer: leaves all GL state as it found it.
#pragma once

#include <functional>
#include <memory>

namespace lambent::gl {

/// What every pass takes for granted and none sets: clip space with the origin at the lower left and depth from 0 to 1,
/// seamless cubes, tightly packed pixels in memory of the CPU, and everything that the host may have switched on and
/// PipelineState does not know (logic operations, sample masks, clip distances, …) as a new context has it.
void setConventions();

/// Saves all state of the context that Lambent's passes set or depend on, sets the conventions, and puts everything
/// back at its end: program, vertex array, framebuffers, viewports and scissors, depth, stencil, blending, masks, clip
/// control, polygons, points, provoking vertex, multisampling, pixel store and its buffers, query buffer, the texture
/// units with their samplers, uniform and storage bindings that passes may use (engine/gl/objects.h), indirect buffer,
/// transform feedback (paused meanwhile if it runs), and the one vertex attribute that is set. No pass touches what is
/// missing here: image units, atomic counters, the other buffers, renderbuffer, program pipeline. What it cannot save
/// must have ended or is lost: queries of samples passed and primitives written, conditional rendering, transform
/// feedback of the default object, and subroutine uniforms.
///
/// Costs 6 µs, 9 µs where every binding point is taken, and 0.004 µs inside another one: llvmpipe, Mesa 22.3.6, 2 cores,
/// StateGuardTest.CostsLittle, 2026-11-25 (twice that with other work on the machine, and on Zink). So everything is kept
/// at once: to keep each binding at its first use would make every bind dearer and save a thousandth of a frame.
///
/// Inside one all code keeps to the conventions, and another on the same thread does nothing: who calls a frame several
/// times takes one around all of it.
class StateGuard {
 public:
  StateGuard();
  ~StateGuard();
  StateGuard(const StateGuard&) = delete;
  StateGuard& operator=(const StateGuard&) = delete;

 private:
  struct Saved;
  std::unique_ptr<const Saved> saved_; // null: there is one around it
};

/// While it lives, code of somebody else is called from the midst of ours, and its guards on this thread save and
/// restore though there are others around.
class CallOut {
 public:
  CallOut();
  ~CallOut();
  CallOut(const CallOut&) = delete;
  CallOut& operator=(const CallOut&) = delete;

 private:
  int depth_; // of guards around it
};

/// A function of somebody else, called out to and with the state of before afterwards.
template <class... Args> std::function<void(Args...)> callingOut(const std::function<void(Args...)>& theirs) {
  if (!theirs) return {};
  return [&theirs](Args... args) {
    const CallOut out;
    theirs(args...);
  };
}

} // namespace lambent::gl
