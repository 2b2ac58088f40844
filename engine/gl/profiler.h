// Times of GPU passes, and the scope that every GPU command runs in: debug group + timer + row.
#pragma once

#include "engine/core/profile.h"
#include "engine/gl/objects.h"

#include <deque>
#include <functional>
#include <map>

namespace lambent::gl {

/// Queries: GPU timestamps, read without waiting, so a row shows the latest known time of its stage (a few frames old).
/// Finish: glFinish around each pass; exact everywhere, but the CPU waits.
enum class Timing { Queries, Finish };

/// Times some work, the GPU's included. Waits for all that it does.
double secondsOf(const std::function<void()>& work);

class GpuProfiler {
 public:
  explicit GpuProfiler(Timing timing = Timing::Finish) : timing_(timing) {}

  /// Finds out whether timestamps can be trusted here, by timing some drawing both ways (5 to 20 ms). llvmpipe's
  /// queries cover about one tile of the work. Chooses Queries when they agree within a factor of two, else Finish;
  /// returns the choice.
  Timing calibrate();
  void choose(Timing timing) { timing_ = timing; }
  Timing timing() const { return timing_; }

  /// Returns the rows since the last call, in the order the scopes ended, and clears them.
  std::vector<StageTime> takeRows();

 private:
  friend class PassScope;
  struct Pending {
    StageKey stage;
    Query begin, end;
  };
  void collectFinishedQueries();

  Timing timing_;
  std::vector<StageTime> rows_;
  std::deque<Pending> pending_;
  std::vector<std::pair<Query, Query>> freeQueries_;
  std::map<uint16_t, double> latestGpuMs_; // by stage
};

/// All GL commands of a pass run inside one of these. Scopes may nest; the outer row then includes the inner.
class PassScope {
 public:
  PassScope(GpuProfiler& profiler, StageKey stage);
  ~PassScope();
  PassScope(const PassScope&) = delete;
  PassScope& operator=(const PassScope&) = delete;

 private:
  GpuProfiler& profiler_;
  StageKey stage_;
  std::chrono::steady_clock::time_point begin_;
  Query beginQuery_, endQuery_;
};

} // namespace lambent::gl
