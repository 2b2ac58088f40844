#include "engine/scene/file_access.h"

#include <algorithm>
#include <system_error>

namespace lambent {

namespace fs = std::filesystem;

bool mayRead(const fs::path& folder, const fs::path& file, FileAccess access) {
  std::error_code failure;
  if (file.native().find('\0') != std::string::npos) return false; // the system reads the part before it
  const fs::path there = fs::canonical(file, failure); // without links; fails where there is nothing
  if (failure || !fs::is_regular_file(there, failure)) return false;
  if (access == FileAccess::Anywhere) return true;
  const fs::path root = fs::canonical(folder.empty() ? "." : folder, failure);
  if (failure) return false;
  return std::mismatch(root.begin(), root.end(), there.begin(), there.end()).first == root.end();
}

bool leadsOutside(const fs::path& address) {
  if (address.is_absolute()) return true;
  const fs::path plain = address.lexically_normal();
  return !plain.empty() && *plain.begin() == "..";
}

} // namespace lambent
