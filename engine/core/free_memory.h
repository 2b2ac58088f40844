// What this machine has left to give.
#pragma once

#include <cstddef>
#include <filesystem>

namespace lambent {

/// Returns the bytes that may still be taken: what is free, or left to the group of processes that this one runs in.
size_t freeMemory();

/// Returns the same for a group of processes alone, whose limits and statistics lie in `folder` (cgroup 2, or 1 below
/// memory/); files that the system keeps in memory count as free. The largest number where it has no limit.
size_t freeOfGroup(const std::filesystem::path& folder);

} // namespace lambent
