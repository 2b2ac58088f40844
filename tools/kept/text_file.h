// Files of text, read and written in one piece.
#pragma once

#include <filesystem>
#include <string>

namespace lambent {

/// In one step: the file is the old or the new one. Throws RunError.
void writeText(const std::filesystem::path& file, const std::string& text);
/// Throws InputError where something by this name is no regular file: pipes wait for ever, and devices have no end.
void requireFileOrNothing(const std::filesystem::path& file);
/// Everything in a regular file; empty where there is none.
std::string readText(const std::filesystem::path& file);

} // namespace lambent
