// Files that targets of tests/fuzz read.
#pragma once

#include "engine/core/error.h"
#include "engine/core/math.h"

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>

#include <unistd.h>

namespace lambent::fuzz {

namespace fs = std::filesystem;

/// This program's own; in memory where there is such a folder.
inline fs::path scratch(const std::string& name) {
  static const fs::path folder = fs::is_directory("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
  return folder / ("lambent-fuzz-" + std::to_string(getpid()) + name);
}

inline void writeBytes(const fs::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

inline std::string readBytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What `write` writes to a file.
template <class Write> std::string written(const std::string& extension, const Write& write) {
  const fs::path file = scratch("-written" + extension);
  write(file);
  const std::string bytes = readBytes(file);
  fs::remove(file);
  return bytes;
}

/// Runs what may refuse; says whether it did not.
template <class Run> bool takes(const Run& run) {
  try {
    run();
    return true;
  } catch (const InputError&) {
  } catch (const RunError&) {
  }
  return false;
}

/// Runs a reader of a file and removes it; says whether it took it.
template <class Read> bool reading(std::string_view bytes, const std::string& extension, const Read& read) {
  const fs::path file = scratch(extension);
  writeBytes(file, bytes);
  const bool taken = takes([&] { read(file); });
  fs::remove(file);
  return taken;
}

/// A folder for the files of one run.
class Folder {
 public:
  explicit Folder(const std::string& name) : path_(scratch(name)) { fs::create_directory(path_); }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  const fs::path path_;
};

inline bool finite(const mat4& m) {
  for (int c = 0; c < 4; ++c)
    if (!isFinite(vec3(m[c]))) return false;
  return true;
}

template <class T> void append(std::string& bytes, std::initializer_list<T> values) {
  for (const T v : values) bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
}

} // namespace lambent::fuzz
