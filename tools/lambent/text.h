// Text that reports are made of.
#pragma once

#include <filesystem>
#include <string>

namespace lambent {

/// As printf, up to 255 characters.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

/// In one step: the file is the old or the new one. Throws RunError.
void writeText(const std::filesystem::path& file, const std::string& text);

/// The folder that a report goes to: `out`, or `unnamed` where that is empty; made where it lacks. Throws RunError.
std::filesystem::path reportFolder(const std::string& out, const std::string& unnamed);

} // namespace lambent
