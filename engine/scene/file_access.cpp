#include "engine/scene/file_access.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Whether a place without links on its way is in a folder or below.
bool isIn(const fs::path& folder, const fs::path& place) {
  std::error_code failure;
  const fs::path root = fs::canonical(folder.empty() ? "." : folder, failure);
  return !failure && std::mismatch(root.begin(), root.end(), place.begin(), place.end()).first == root.end();
}

} // namespace

bool mayRead(const fs::path& folder, const fs::path& file, bool outside) {
  std::error_code failure;
  if (file.native().find('\0') != std::string::npos) return false; // the system reads the part before it
  const fs::path there = fs::canonical(file, failure);             // without links; fails where there is nothing
  if (failure || !fs::is_regular_file(there, failure)) return false;
  return outside || isIn(folder, there);
}

HeldFile::HeldFile(const fs::path& folder, const fs::path& file, bool outside)
    : descriptor_(mayRead(folder, file, outside) ? open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)
                                                 : -1) {
  if (descriptor_ < 0) {
    if (errno == EACCES && mayRead(folder, file, outside)) why_ = "cannot be opened for reading";
    return;
  }
  struct stat status {};
  std::error_code failure;
  const bool regular = fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
  if (regular && (outside || isIn(folder, fs::read_symlink(opened(), failure)))) return;
  close(descriptor_);
  descriptor_ = -1;
}

HeldFile::~HeldFile() {
  if (descriptor_ >= 0) close(descriptor_);
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
