#include "engine/scene/file_access.h"

#include <algorithm>
#include <system_error>

namespace lambent {

namespace fs = std::filesystem;

bool mayRead(const fs::path& folder, const fs::path& file, bool outside) {
  std::error_code failure;
  if (file.native().find('\0') != std::string::npos) return false; // the system reads the part before it
  const fs::path there = fs::canonical(file, failure);             // without links; fails where there is nothing
  if (failure || !fs::is_regular_file(there, failure)) return false;
  if (outside) return true;
  const fs::path root = fs::canonical(folder.empty() ? "." : folder, failure);
  if (failure) return false;
  return std::mismatch(root.begin(), root.end(), there.begin(), there.end()).first == root.end();
}

bool leadsOutside(const fs::path& folder, const fs::path& file) {
  const fs::path way = file.lexically_proximate(folder.empty() ? "." : folder);
  fs::path at = folder;
  int below = 0;
  for (const fs::path& step : way) {
    if (step == "." || step.empty()) continue;
    below += step == ".." ? -1 : 1;
    if (below < 0) return true;
    at /= step;
    std::error_code none;
    if (fs::is_symlink(fs::symlink_status(at, none))) return true;
  }
  return false;
}

std::string pathOfUri(const std::string& uri) {
  const auto digit = [&](size_t i) {
    const char c = i < uri.size() ? uri[i] : 'x';
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0;
    out += escape ? char(16 * digit(i + 1) + digit(i + 2)) : uri[i];
    if (escape) i += 2;
  }
  return out;
}

} // namespace lambent
