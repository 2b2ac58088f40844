#include "tools/lambent/html.h"

#include "tools/lambent/linear_picture.h"

#include <fstream>
#include <iterator>

namespace lambent {

namespace fs = std::filesystem;

namespace {

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

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

std::string htmlHead(const std::string& title) {
  return "<!doctype html><html lang='en'><meta charset='utf-8'><title>" + escaped(title) + "</title><style>" + kStyle +
         "</style><h1>" + escaped(title) + "</h1>\n";
}

std::string htmlTable(const std::vector<TableColumn>& columns, const nlohmann::json& rows) {
  std::string out = "<table><tr>";
  const auto text = [](std::string cell) { // without what Markdown needs
    std::erase(cell, '\\');
    return escaped(cell);
  };
  for (const TableColumn& c : columns) out += "<th>" + text(c.title) + "</th>";
  out += "</tr>\n";
  for (const nlohmann::json& row : rows) {
    out += "<tr>";
    for (const TableColumn& c : columns) out += "<td>" + text(cellText(c, row)) + "</td>";
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

std::string htmlPicture(const fs::path& folder, const std::string& name, const Image& shown, const std::string& under) {
  const fs::path file = folder / (name + ".png");
  writeShown(file.string(), shown);
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  return "<figure><img alt='" + escaped(under) + "' src='data:image/png;base64," + base64(bytes) + "'><figcaption>" +
         escaped(under) + "</figcaption></figure>\n";
}

} // namespace lambent
