// Parallel loops over index ranges on TBB. A body writes only to its own indices, so results do not depend on the
// number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace lambent {

/// Bounds the worker threads of all later loops; 0 = all cores. Must be called from the main thread.
void setThreadCount(int threads);
int threadCount();

/// Threads of one's own, for whoever must not use those of the process: of all loops that run() begins on this thread,
/// and on threads that go on with its work inside run() of the same.
class Workers {
 public:
  explicit Workers(int threads); // the caller included; 0: one for each core
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  void run(const std::function<void()>& work);
  /// Those around what this thread does; null: the process's.
  static Workers* current();

  struct Arena;

 private:
  std::unique_ptr<Arena> arena_;
};

/// Calls body(begin, end) over disjoint blocks that cover [0, n): block i begins at i · grain, all but the last have
/// `grain` indices.
void parallelFor(size_t n, size_t grain, const std::function<void(size_t, size_t)>& body);

/// Calls body(begin, end, counts of the block) likewise, and adds the counts of all blocks to `sum`.
template <class Counts, class Body> void parallelCount(size_t n, size_t grain, Counts& sum, const Body& body) {
  std::vector<Counts> perBlock((n + grain - 1) / grain);
  parallelFor(n, grain, [&](size_t begin, size_t end) { body(begin, end, perBlock[begin / grain]); });
  for (const Counts& c : perBlock) sum += c;
}

} // namespace lambent
