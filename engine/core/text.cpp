#include "engine/core/text.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace lambent {

namespace {

/// Bytes of the character that a text begins with; 0: it is no UTF-8.
size_t characterLength(std::string_view text) {
  const auto c = static_cast<unsigned char>(text[0]);
  const size_t length = c < 0x80 ? 1 : c < 0xc2 ? 0 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : c < 0xf5 ? 4 : 0;
  if (length > text.size()) return 0;
  for (size_t i = 1; i < length; ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 0;
  return length;
}

/// Levenshtein distance, one row at a time.
size_t editDistance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t(0));
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replace = diagonal + (lower(a[i - 1]) != lower(b[j - 1]));
      diagonal = row[j];
      row[j] = std::min({replace, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// What `text` begins with, if it turns the direction of what follows on a terminal: U+200E, U+200F, U+202A to U+202E,
/// U+2066 to U+2069 and U+061C, in UTF-8.
std::string_view directionMark(std::string_view text) {
  if (text.starts_with("\xd8\x9c")) return text.substr(0, 2);
  if (text.size() < 3 || text[0] != '\xe2') return {};
  const auto second = static_cast<unsigned char>(text[1]), third = static_cast<unsigned char>(text[2]);
  const bool turns = second == 0x80 ? third == 0x8e || third == 0x8f || (third >= 0xaa && third <= 0xae)
                                    : second == 0x81 && third >= 0xa6 && third <= 0xa9;
  return turns ? text.substr(0, 3) : std::string_view();
}

} // namespace

std::string printable(std::string_view text) {
  constexpr size_t kLongest = 2500, kBegin = 1900, kEnd = 500; // bytes; names may have a megabyte
  if (text.size() > kLongest) {
    const auto within = [&](size_t at) { return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80; }; // a character
    size_t begin = kBegin, end = text.size() - kEnd;
    while (begin > 0 && within(begin)) --begin;
    while (end < text.size() && within(end)) ++end;
    return printable(text.substr(0, begin)) + " … " + printable(text.substr(end));
  }
  std::string out;
  const auto escape = [&](unsigned char c) {
    constexpr char digits[] = "0123456789abcdef";
    (out += "\\x") += digits[c >> 4];
    out += digits[c & 15];
  };
  for (size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const unsigned char next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    if (c < 0x20 || c == 0x7f) {
      escape(c);
    } else if (c == 0xc2 && next >= 0x80 && next < 0xa0) { // U+0080 to U+009F in UTF-8
      escape(next);
      ++i;
    } else if (const std::string_view turning = directionMark(text.substr(i)); !turning.empty()) {
      for (const char byte : turning) escape(static_cast<unsigned char>(byte));
      i += turning.size() - 1;
    } else if (const size_t length = characterLength(text.substr(i)); length == 0) {
      escape(c);
    } else {
      out += text.substr(i, length);
      i += length - 1;
    }
  }
  return out;
}

std::string nearestName(std::string_view name, std::span<const std::string> candidates) {
  const std::string* best = nullptr;
  size_t bestDistance = 0;
  for (const std::string& candidate : candidates) {
    const size_t distance = editDistance(name, candidate);
    if (best && distance >= bestDistance) continue;
    best = &candidate;
    bestDistance = distance;
  }
  if (!best || bestDistance * 3 > 2 * std::max(name.size(), best->size())) return {};
  return *best;
}

std::string guessText(std::string_view name, std::span<const std::string> known, const std::string& otherwise) {
  const std::string near = nearestName(name, known);
  return near.empty() ? otherwise : "did you mean " + near + "?";
}

std::string joined(std::span<const std::string> names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

} // namespace lambent
