#include "engine/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
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
  // Not blocked_range(0, n, grain): it halves until a block is small enough, so two blocks may begin within one grain,
  // and bodies that count into element begin / grain would write to the same one.
  const size_t blocks = (n + grain - 1) / grain;
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, blocks, 1),
      [&](const tbb::blocked_range<size_t>& r) {
        for (size_t i = r.begin(); i < r.end(); ++i) body(i * grain, std::min(n, (i + 1) * grain));
      },
      tbb::simple_partitioner());
}

} // namespace lambent
