#include "engine/core/text.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace lambent {

namespace {

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

} // namespace

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

} // namespace lambent
