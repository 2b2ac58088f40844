// Files that are written whole or not at all: to a temporary name next to the target, which is then renamed.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace lambent {

/// Checks before long work that a file can be written. Throws RunError where it cannot: no such folder, one that is not
/// writable, a folder by its name.
void checkWritable(const std::filesystem::path& file);

/// Calls write(temporary) and renames the temporary to `file`; removes it and rethrows on failure. Throws RunError when
/// the folder cannot be written.
void writeAtomically(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& write);
/// The same for a file of these bytes.
void writeAtomically(const std::filesystem::path& file, std::string_view bytes);

/// Removes temporaries of `file` left by programs that were killed while they wrote. What another one writes stays.
void removeLeftovers(const std::filesystem::path& file);

} // namespace lambent
