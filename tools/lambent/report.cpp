#include "tools/lambent/report.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/platform/gl_context.h"
#include "tools/lambent/command_line.h"
#include "tools/lambent/picture.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <thread>

namespace lambent {

namespace fs = std::filesystem;

namespace {

std::string cellText(const TableColumn& column, const Value& row) {
  if (!row.has(column.key)) return "";
  const Value& value = row[column.key];
  if (value.isText()) return value.text();
  std::string text;
  for (const Value& number : value.isList() ? value.items() : Value::List{value}) {
    const double n = number.number();
    text += text.empty() ? "" : ", ";
    text += n == 0 && column.ofZero ? column.ofZero
            : std::isfinite(n)      ? format(column.pattern, column.factor * n)
                                    : "–";
  }
  return text;
}

constexpr const char* kStyle =
    "body{font:15px/1.45 sans-serif;max-width:1320px;margin:2em auto;padding:0 1em;color:#111;background:#fff}"
    "table{border-collapse:collapse;margin:.6em 0;font-size:13px}th,td{border:1px solid #bbb;padding:2px "
    "7px;text-align:right}"
    "td:first-child,th:first-child{text-align:left}figure{display:inline-block;margin:4px;vertical-align:top;width:"
    "320px}"
    "figure img{width:320px;image-rendering:pixelated;border:1px solid #999}figcaption{font-size:12px}"
    ".pair{display:inline-block;white-space:nowrap}.pair figcaption{white-space:normal}svg{max-width:100%;height:auto}"
    "details{margin:.6em 0}@media print{details{display:block}h2{break-before:page}}";

std::string base64(const std::string& bytes) {
  static const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) out += i + k < bytes.size() + 1 ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

} // namespace

std::string format(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string nameOf(const std::string& file) { return fs::path(file).stem().string(); }

std::string tableText(const std::vector<TableColumn>& columns, const Value& rows) {
  std::string head = "|", rule = "|", text;
  for (const TableColumn& c : columns) head += format(" %s |", c.title), rule += "---|";
  for (const Value& row : rows.items()) {
    text += "|";
    for (const TableColumn& c : columns) text += " " + cellText(c, row) + " |";
    text += "\n";
  }
  return head + "\n" + rule + "\n" + text;
}

std::string csvText(const Value& rows) {
  std::map<std::string, bool> keys; // and whether any is more than one number or text
  for (const Value& row : rows.items())
    for (const auto& [key, value] : row.fields()) keys[key] |= value.isList() || value.isObject();
  std::erase_if(keys, [](const auto& key) { return key.second; });
  if (keys.empty()) return "";
  std::string text;
  for (const auto& [key, structured] : keys) text += (text.empty() ? "" : ",") + key;
  for (const Value& row : rows.items()) {
    std::string cells;
    for (const auto& [key, structured] : keys) cells += "," + cellText({key.c_str(), ""}, row);
    text += "\n" + cells.substr(1);
  }
  return text + "\n";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

std::string htmlHead(const std::string& title) {
  return "<!doctype html><html lang='en'><meta charset='utf-8'><title>" + escaped(title) + "</title><style>" + kStyle +
         "</style><h1>" + escaped(title) + "</h1>\n";
}

std::string htmlTable(const std::vector<TableColumn>& columns, const Value& rows) {
  const auto line = [&](const char* tag, auto&& cell) {
    std::string out;
    for (const TableColumn& c : columns) {
      std::string text = cell(c);
      std::erase(text, '\\'); // what Markdown needs
      out += format("<%s>", tag) + escaped(text) + format("</%s>", tag);
    }
    return out + "</tr>\n";
  };
  std::string out = "<table><tr>" + line("th", [](const TableColumn& c) -> std::string { return c.title; });
  for (const Value& row : rows.items())
    out += "<tr>" + line("td", [&](const TableColumn& c) { return cellText(c, row); });
  return out + "</table>\n";
}

std::string htmlPicture(const fs::path& folder, const std::string& name, const Image& shown, const std::string& under) {
  const fs::path file = folder / (name + ".png");
  writeShown(file.string(), shown);
  return "<figure><img alt='" + escaped(under) + "' src='data:image/png;base64," + base64(readText(file)) +
         "'><figcaption>" + escaped(under) + "</figcaption></figure>\n";
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
  return format("%u threads of ", std::thread::hardware_concurrency()) + cpu + "; OpenGL: " + renderer + "; " + date;
}

void writeJson(const std::string& file, const Value& figures) {
  if (file.empty()) return;
  writeText(file, figures.json(2) + "\n");
  keepFromReplacing(file);
}

void writeReport(const OutputOptions& output, const fs::path& folder, const std::string& name,
                 const std::string& heading, const std::string& text, const std::string& csv, const Value& figures) {
  writeJson(output.json, figures);
  writeText(folder / (name + ".csv"), csv);
  const fs::path page = folder / (name + ".md");
  writeText(page, escaped("# " + heading + "\n\n" + text));    // names of files may look like HTML
  const std::string printed = text.substr(0, text.find("![")); // pictures stand at the end, and are for the page
  if (!output.quiet) std::printf("%s\nreport: %s\n", printed.c_str(), page.c_str());
}

void refuseNamesakes(const std::vector<std::string>& files) {
  for (size_t i = 0; i < files.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (nameOf(files[i]) == nameOf(files[k]))
        throw InputError(files[i], "is called as " + files[k] + " is (rename one: what is written is named by them)");
}

fs::path resultFolder(const OutputOptions& output, const std::string& unnamed) {
  const fs::path folder = output.out.empty() ? unnamed : output.out;
  makeFolder(folder);
  refuseLinksIn(folder);
  if (output.json.empty()) return folder;
  checkWritable(output.json);
  std::error_code none;
  const fs::path json = fs::weakly_canonical(fs::absolute(leadsTo(output.json), none), none);
  const fs::path below = json.lexically_relative(fs::canonical(folder, none));
  if (json.extension() != ".json" && !below.empty() && *below.begin() != "..")
    throw InputError("--json " + output.json, "may be a result's own name: in that folder, call it NAME.json");
  return folder;
}

fs::path reportFolder(const OutputOptions& output, const std::string& unnamed, const std::vector<std::string>& names) {
  const fs::path folder = resultFolder(output, unnamed);
  replaceOnlyOwnIn(folder);
  for (const std::string& name : names) checkWritable(folder / name);
  if (!output.json.empty()) checkWritable(output.json);
  return folder;
}

} // namespace lambent
