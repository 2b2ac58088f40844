#include "engine/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>

namespace lambent {

namespace {
std::unique_ptr<tbb::global_control>& control() {
  static std::unique_ptr<tbb::global_control> c;
  return c;
}
} // namespace

void setThreadCount(int threads) {
  control().reset();
  if (threads > 0)
    control() = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
}

int threadCount() { return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)); }

void parallelFor(size_t n, size_t grain, const std::function<void(size_t, size_t)>& body) {
  if (n == 0) return;
  // simple_partitioner: block borders depend on n and grain only, never on how work was stolen.
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, n, grain), [&](const tbb::blocked_range<size_t>& r) { body(r.begin(), r.end()); },
      tbb::simple_partitioner());
}

} // namespace lambent
