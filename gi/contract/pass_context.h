// What every GPU pass works with.
#pragma once

#include "engine/gl/profiler.h"
#include "engine/gl/program.h"
#include "gi/plan/settings.h"
#include "gi/plan/stages.h"

namespace lambent {

/// References that every pass holds: the objects must outlive the passes.
struct PassContext {
  gl::ProgramCache& programs;
  gl::GpuProfiler& profiler;
  Makers makers = Makers::ByRule;

  /// Opens the scope that all GL commands of a stage run inside.
  gl::PassScope scope(StageId stage) const { return {profiler, key(stage)}; }
};

} // namespace lambent
