// What this machine has left to give.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>

namespace lambent {

/// Returns the bytes that may still be taken: what is free, or left to the group of processes that this one runs in.
size_t freeMemory();

/// Returns the same for a group of processes alone, whose limits and statistics lie in `folder` (cgroup 2, or 1 below
/// memory/); files that the system keeps in memory count as free. The largest number where it has no limit.
size_t freeOfGroup(const std::filesystem::path& folder);

/// While it lives the process gets no more than so many bytes, and 128 MiB for what other threads do, beside what it has:
/// an allocation beyond throws std::bad_alloc, in any thread. One lives at a time; who makes another waits.
class AllocationLimit {
 public:
  explicit AllocationLimit(size_t bytes);
  ~AllocationLimit();
  AllocationLimit(const AllocationLimit&) = delete;

 private:
  std::unique_lock<std::mutex> alone_;
  std::optional<uint64_t> before_; // the system's limit, where it was lowered
};

} // namespace lambent
