#include "tools/kept/text_file.h"

#include "engine/core/error.h"
#include "engine/core/files.h"

#include <fstream>
#include <iterator>

namespace lambent {

namespace fs = std::filesystem;

void writeText(const fs::path& file, const std::string& text) {
  writeAtomically(file, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << text;
    if (!out.flush()) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

void requireFileOrNothing(const fs::path& file) {
  std::error_code none;
  const fs::file_status status = fs::symlink_status(file, none);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw InputError(file.string(), (fs::is_symlink(status) ? "is a link" : "is not a file") +
                                        std::string(" (remove it, or name another folder)"));
}

std::string readText(const fs::path& file) {
  std::error_code none;
  if (!fs::is_regular_file(file, none)) return {};
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace lambent
