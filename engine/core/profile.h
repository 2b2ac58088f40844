// Stage times. CPU scopes are wall time of the calling thread; GPU scopes are added by engine/gl.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace lambent {

/// Says which stage a time belongs to: a row of the measuring module's list (gi/plan/stages.h).
struct StageKey {
  uint16_t id = 0;
  const char* name = ""; // of static storage
  bool operator==(const StageKey& o) const { return id == o.id; }
};

struct StageTime {
  StageKey stage;
  double cpuMs = 0; // wall time between begin and end on the calling thread
  double gpuMs = 0; // by timer queries; the same as cpuMs where the pass was finished with glFinish; 0 for CPU stages
};

/// Adds a row to `rows` when it goes out of scope.
class CpuScope {
 public:
  CpuScope(std::vector<StageTime>& rows, StageKey stage)
      : rows_(rows), stage_(stage), begin_(std::chrono::steady_clock::now()) {}
  ~CpuScope() {
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begin_;
    rows_.push_back({stage_, ms.count(), 0});
  }
  CpuScope(const CpuScope&) = delete;
  CpuScope& operator=(const CpuScope&) = delete;

 private:
  std::vector<StageTime>& rows_;
  StageKey stage_;
  std::chrono::steady_clock::time_point begin_;
};

} // namespace lambent
