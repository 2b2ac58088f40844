#include "engine/core/resources.h"

#include "engine/core/error.h"

#include <atomic>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include <sys/mman.h>
#include <sys/resource.h>

namespace lambent {

namespace {

/// How many of so many threads there may be at once.
int threadsOf(int wanted) {
  std::atomic<bool> end = false;
  std::vector<std::jthread> threads;
  threads.reserve(size_t(wanted));
  try {
    while (int(threads.size()) < wanted) threads.emplace_back([&] { end.wait(false); });
  } catch (const std::exception&) { // no more
  }
  end = true;
  end.notify_all();
  return int(threads.size());
}

} // namespace

void requireResources(int wanted) {
  constexpr size_t kAddresses = size_t(1) << 30; // what a small scene's frame takes on software Mesa
  void* const room = mmap(nullptr, kAddresses, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room != MAP_FAILED) munmap(room, kAddresses);
  rlimit data{};
  const bool little = getrlimit(RLIMIT_DATA, &data) == 0 && data.rlim_cur < kAddresses;
  if (room == MAP_FAILED || little)
    throw RunError(std::string("this process may not take 1 GB of memory (is there a limit? ulimit -") +
                   (little ? "d" : "v") + " unlimited lifts it)");
  constexpr rlim_t kStack = 256 * 1024; // each thread's default too; 128 KB were enough
  rlimit stack{};
  if (getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < kStack)
    throw RunError("this process may not take 256 KB of stack (is there a limit? ulimit -s 8192 lifts it)");
  const int got = threadsOf(wanted);
  if (got < wanted)
    throw RunError("this process may make only " + std::to_string(got) + " of the " + std::to_string(wanted) +
                   " threads it needs (raise the limits, ulimit -u and -v, or lower --threads)");
}

} // namespace lambent
