#include "engine/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

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

struct Workers::Arena {
  tbb::task_arena threads;
};

namespace {
thread_local Workers* workersAround = nullptr;
thread_local Workers::Arena* arenaAround = nullptr;
} // namespace

Workers::Workers(int threads)
    : arena_(new Arena{tbb::task_arena(threads > 0 ? threads : tbb::task_arena::automatic)}) {}
Workers::~Workers() = default;
Workers* Workers::current() { return workersAround; }

void Workers::run(const std::function<void()>& work) {
  struct Scope {
    Workers* workers = workersAround;
    Arena* arena = arenaAround;
    ~Scope() { workersAround = workers, arenaAround = arena; }
  } const before;
  workersAround = this;
  arenaAround = arena_.get();
  work();
}

void parallelFor(size_t n, size_t grain, const std::function<void(size_t, size_t)>& body) {
  // Not blocked_range(0, n, grain): it halves until a block is small enough, so two blocks may begin within one grain,
  // and bodies that count into element begin / grain would write to the same one.
  const size_t blocks = (n + grain - 1) / grain;
#ifdef __SANITIZE_THREAD__ // which does not see when TBB's threads wait for each other
  std::atomic<size_t> next = 0;
  std::vector<std::jthread> threads;
  for (size_t t = 0; t < std::min<size_t>(blocks, 4); ++t)
    threads.emplace_back([&] {
      for (size_t i = next++; i < blocks; i = next++) body(i * grain, std::min(n, (i + 1) * grain));
    });
#else
  const auto loop = [&] {
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, blocks, 1),
        [&](const tbb::blocked_range<size_t>& r) {
          for (size_t i = r.begin(); i < r.end(); ++i) body(i * grain, std::min(n, (i + 1) * grain));
        },
        tbb::simple_partitioner());
  };
  arenaAround ? arenaAround->threads.execute(loop) : loop();
#endif
}

} // namespace lambent
