// Text that reports are made of.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace lambent {

class GlContext;

/// As printf, up to 255 characters.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

/// A column of a table whose rows are JSON objects. Texts are taken as they are, lists are joined by commas, and what
/// lacks stays empty.
struct TableColumn {
  const char *key, *title;
  const char* pattern = "%g";   // of one number
  double factor = 1;            // on it, as 100 for per cent
  const char* ofZero = nullptr; // what stands for 0
};
std::string cellText(const TableColumn& column, const nlohmann::json& row);
/// In Markdown.
std::string tableText(const std::vector<TableColumn>& columns, const nlohmann::json& rows);
/// All that is one number or text, by key.
std::string csvText(const nlohmann::json& rows);

/// Processor, OpenGL renderer, day.
std::string machineText(const GlContext& context);

/// In one step: the file is the old or the new one. Throws RunError.
void writeText(const std::filesystem::path& file, const std::string& text);

/// The folder that a report goes to: `out`, or `unnamed` where that is empty; made where it lacks. Throws RunError.
std::filesystem::path reportFolder(const std::string& out, const std::string& unnamed);

} // namespace lambent
