#include "engine/core/free_memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace lambent {

namespace {

constexpr size_t kUnknown = std::numeric_limits<size_t>::max();

/// The number that a file begins with.
size_t numberIn(const std::filesystem::path& file) {
  size_t value = 0;
  return std::ifstream(file) >> value ? value : kUnknown;
}

} // namespace

size_t freeMemory() {
  size_t free = kUnknown;
  std::ifstream all("/proc/meminfo");
  for (std::string name, unit; free == kUnknown && all >> name;) {
    size_t kib = 0;
    if (!(all >> kib)) break;
    std::getline(all, unit);
    if (name == "MemAvailable:") free = kib << 10;
  }
  return std::min(free, freeOfGroup("/sys/fs/cgroup"));
}

AllocationLimit::AllocationLimit(size_t bytes) {
  static std::mutex one;
  alone_ = std::unique_lock(one);
  const size_t pages = numberIn("/proc/self/statm"); // of addresses, which is what the system counts
  rlimit limit{};
  if (pages == kUnknown || getrlimit(RLIMIT_AS, &limit) != 0) return;
  constexpr uint64_t kForOthers = 128 << 20; // of the program's threads, meanwhile
  const uint64_t most = pages * uint64_t(sysconf(_SC_PAGESIZE)) + bytes + kForOthers, before = limit.rlim_cur;
  if (most >= before) return;
  limit.rlim_cur = most;
  if (setrlimit(RLIMIT_AS, &limit) == 0) before_ = before;
}

AllocationLimit::~AllocationLimit() {
  rlimit limit{};
  if (!before_ || getrlimit(RLIMIT_AS, &limit) != 0) return;
  limit.rlim_cur = *before_;
  setrlimit(RLIMIT_AS, &limit);
}

size_t freeOfGroup(const std::filesystem::path& folder) {
  struct Version {
    const char *limit, *used, *cached; // cached: files of which the system forgets what it needs room for
  };
  constexpr Version kVersions[] = {
      {"memory.max", "memory.current", "inactive_file"},
      {"memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes", "total_inactive_file"}};
  size_t free = kUnknown;
  for (const Version& v : kVersions) {
    const size_t limit = numberIn(folder / v.limit), used = numberIn(folder / v.used);
    if (limit == kUnknown || used == kUnknown) continue;
    size_t cached = 0, value = 0;
    std::ifstream statistics((folder / v.used).replace_filename("memory.stat"));
    for (std::string name; statistics >> name >> value;)
      if (name == v.cached) cached = value;
    free = std::min(free, limit - std::min(limit, used - std::min(used, cached)));
  }
  return free;
}

} // namespace lambent
