#include "engine/core/files.h"

#include "engine/core/error.h"

#include <fstream>
#include <random>
#include <system_error>

#include <unistd.h>

namespace lambent {

namespace fs = std::filesystem;

void checkWritable(const fs::path& file) {
  std::error_code none;
  const fs::path folder = file.parent_path().empty() ? "." : file.parent_path();
  const auto refuse = [&](const std::string& why) { throw RunError(file.string() + ": cannot be written: " + why); };
  if (!fs::is_directory(folder, none)) refuse("there is no folder " + folder.string());
  if (fs::is_directory(file, none)) refuse("it is a folder");
  if (fs::exists(file, none) && !fs::is_regular_file(file, none)) return; // a device or a pipe
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse("the folder " + folder.string() + " is not writable");
}

namespace {
constexpr size_t kLongestStem = 100; // of 255 bytes that a name may have: a temporary's fits where the target's does
}

void writeAtomically(const fs::path& named, const std::function<void(const fs::path&)>& write) {
  std::error_code none;
  const fs::path resolved = fs::canonical(named, none); // a link stays one, and what it leads to is written
  const fs::path file = resolved.empty() ? named : resolved;
  if (fs::exists(file, none) && !fs::is_regular_file(file, none) && !fs::is_directory(file, none))
    return write(file); // a device or a pipe: nothing to keep, and a rename would put a file in its place
  // The random part keeps two programs that write the same target apart; the extension stays last because some
  // encoders choose their format by it.
  fs::path temporary = file;
  temporary.replace_filename("." + file.stem().string().substr(0, kLongestStem) + "." +
                             std::to_string(std::random_device{}()) + file.extension().string());
  std::error_code ignored;
  checkWritable(file);
  try {
    write(temporary);
    fs::rename(temporary, file);
  } catch (const fs::filesystem_error& e) {
    fs::remove(temporary, ignored);
    throw RunError(file.string() + ": cannot be written: " + e.code().message());
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
}

void writeAtomically(const fs::path& file, std::string_view bytes) {
  writeAtomically(file, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), std::streamsize(bytes.size()));
    out.close();
    if (!out) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

void removeLeftovers(const fs::path& file) {
  const std::string begin = "." + file.stem().string().substr(0, kLongestStem) + ".", end = file.extension().string();
  std::error_code ignored;
  for (const fs::directory_entry& e :
       fs::directory_iterator(file.parent_path().empty() ? "." : file.parent_path(), ignored)) {
    const std::string name = e.path().filename().string();
    if (name.size() <= begin.size() + end.size() || !name.starts_with(begin) || !name.ends_with(end)) continue;
    const std::string between = name.substr(begin.size(), name.size() - begin.size() - end.size());
    if (between.find_first_not_of("0123456789") == between.npos) fs::remove(e.path(), ignored);
  }
}

} // namespace lambent
