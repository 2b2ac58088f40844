// What every GPU pass works with.
#pragma once

#include "engine/gl/profiler.h"
#include "engine/gl/program.h"
#include "gi/plan/stages.h"

namespace lambent {

/// Must outlive the passes.
struct PassContext {
  gl::ProgramCache& programs;
  gl::GpuProfiler& profiler;

  /// What all GL commands of a stage run inside.
  gl::PassScope scope(StageId stage) const { return {profiler, key(stage)}; }
};

} // namespace lambent
