#include "tools/lambent/text.h"

#include "engine/core/error.h"
#include "engine/core/image.h"

#include <cstdarg>
#include <cstdio>
#include <fstream>

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

} // namespace lambent
