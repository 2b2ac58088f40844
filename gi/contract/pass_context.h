// What every GPU pass works with.
#pragma once

#include "engine/gl/context.h"
#include "engine/gl/profiler.h"
#include "engine/gl/program.h"
#include "gi/contract/makers.h"
#include "gi/plan/stages.h"

namespace lambent {

/// References that every pass holds: the objects must outlive the passes. Made while the context is current.
struct PassContext {
  gl::ProgramCache& programs;
  gl::GpuProfiler& profiler;
  Makers makers = Makers::ByRule;
  bool drawnByCpu = gl::drawnByCpu();

  /// Opens the scope that all GL commands of a stage run inside.
  gl::PassScope scope(StageId stage) const { return {profiler, key(stage)}; }
};

} // namespace lambent
