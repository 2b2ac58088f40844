// Stage times. CPU scopes are wall time of the calling thread; GPU scopes are added by engine/gl.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace lambent {

struct StageTime {
  std::string name;
  double cpuMs = 0; // wall time between begin and end on the calling thread
  double gpuMs =
      0; // from timer queries, or the same as cpuMs where the pass was finished with glFinish; 0 for CPU stages
};

/// Adds a row to `rows` when it goes out of scope.
class CpuScope {
 public:
  CpuScope(std::vector<StageTime>& rows, std::string name)
      : rows_(rows), name_(std::move(name)), begin_(std::chrono::steady_clock::now()) {}
  ~CpuScope() {
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begin_;
    rows_.push_back({std::move(name_), ms.count(), 0});
  }
  CpuScope(const CpuScope&) = delete;
  CpuScope& operator=(const CpuScope&) = delete;

 private:
  std::vector<StageTime>& rows_;
  std::string name_;
  std::chrono::steady_clock::time_point begin_;
};

} // namespace lambent
