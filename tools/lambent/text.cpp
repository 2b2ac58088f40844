#include "tools/lambent/text.h"

#include "engine/core/error.h"
#include "engine/core/image.h"
#include "engine/platform/gl_context.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <map>
#include <thread>

namespace lambent {

namespace fs = std::filesystem;

std::string format(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string cellText(const TableColumn& column, const nlohmann::json& row) {
  if (!row.contains(column.key)) return "";
  const nlohmann::json& value = row[column.key];
  if (value.is_string()) return value;
  std::string text;
  for (const nlohmann::json& number : value.is_array() ? value : nlohmann::json::array({value})) {
    const double n = number.is_boolean() ? number.get<bool>() : number.get<double>();
    text += text.empty() ? "" : ", ";
    text += n == 0 && column.ofZero ? column.ofZero
            : std::isfinite(n)      ? format(column.pattern, column.factor * n)
                                    : "–";
  }
  return text;
}

std::string tableText(const std::vector<TableColumn>& columns, const nlohmann::json& rows) {
  std::string head = "|", rule = "|", text;
  for (const TableColumn& c : columns) head += format(" %s |", c.title), rule += "---|";
  for (const nlohmann::json& row : rows) {
    text += "|";
    for (const TableColumn& c : columns) text += " " + cellText(c, row) + " |";
    text += "\n";
  }
  return head + "\n" + rule + "\n" + text;
}

std::string csvText(const nlohmann::json& rows) {
  std::map<std::string, bool> keys;
  for (const nlohmann::json& row : rows)
    for (const auto& [key, value] : row.items()) keys[key] |= value.is_structured();
  std::string text;
  const auto line = [&](const auto& cell) {
    std::string cells;
    for (const auto& [key, structured] : keys)
      if (!structured) cells += "," + cell(key);
    if (!cells.empty()) text += cells.substr(1) + "\n"; // of no rows nothing
  };
  line([](const std::string& key) { return key; });
  for (const nlohmann::json& row : rows) line([&](const std::string& key) { return cellText({key.c_str(), ""}, row); });
  return text;
}

void writeText(const fs::path& file, const std::string& text) {
  writeAtomically(file, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << text;
    if (!out.flush()) throw RunError(file.string() + ": cannot be written");
  });
}

fs::path reportFolder(const std::string& out, const std::string& unnamed) {
  const fs::path folder = out.empty() ? fs::path(unnamed) : fs::path(out);
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw RunError(folder.string() + ": cannot be made: " + failure.message());
  return folder;
}

std::string machineText(const GlContext& context) {
  std::string renderer = "?", cpu = "?";
  for (const auto& [name, value] : context.info())
    if (name == "renderer") renderer = value;
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) {
      cpu = line.substr(line.find(':') + 2);
      break;
    }
  const std::time_t now = std::time(nullptr);
  char date[16] = "";
  std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
  return std::to_string(std::thread::hardware_concurrency()) + " threads of " + cpu + "; OpenGL: " + renderer + "; " +
         date;
}

} // namespace lambent
