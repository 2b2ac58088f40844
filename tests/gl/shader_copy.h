// Shaders of the program, changed for a test.
#pragma once

#include "engine/core/error.h"
#include "engine/gl/program.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace lambent::test {

/// A copy of the shader folder, removed at the end.
class ShaderCopy {
 public:
  ShaderCopy() : path(std::filesystem::temp_directory_path() / ("lambent-shader-copy-" + std::to_string(getpid()))) {
    std::filesystem::copy(gl::findShaderFolder(), path, std::filesystem::copy_options::recursive);
  }
  ~ShaderCopy() { std::filesystem::remove_all(path); }
  ShaderCopy(const ShaderCopy&) = delete;
  ShaderCopy& operator=(const ShaderCopy&) = delete;

  std::string read(const std::string& file) const {
    std::stringstream text;
    text << std::ifstream(path / file).rdbuf();
    return text.str();
  }
  /// The first `from` becomes `to`; it must be there.
  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = read(file);
    const size_t at = text.find(from);
    CHECK(at != std::string::npos);
    std::ofstream(path / file) << text.replace(at, from.size(), to);
  }
  std::filesystem::path path;
};

} // namespace lambent::test
