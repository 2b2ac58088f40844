// Shaders of the program, changed for a test.
#pragma once

#include "engine/gl/program.h"
#include "tests/support/files.h"

namespace lambent::test {

/// A folder of the shaders that tests run with (the built-in ones, or those of LAMBENT_SHADERS), removed at the end.
class ShaderCopy {
 public:
  ShaderCopy() {
    const fs::path given = gl::shaderFolder();
    for (const gl::BuiltInShader& shader : gl::builtInShaders()) {
      fs::create_directories((path / shader.file).parent_path());
      writeBytes(path / shader.file, given.empty() ? std::string(shader.text) : readBytes(given / shader.file));
    }
  }

  std::string read(const std::string& file) const { return readBytes(path / file); }
  void write(const std::string& file, const std::string& text) const {
    writeBytes(path / file, text);
    // File times may be coarser than the time between two writes of a test.
    fs::last_write_time(path / file, fs::file_time_type::clock::now() + std::chrono::seconds(++writes_));
  }
  /// The first `from` becomes `to`; it must be there.
  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = read(file);
    const size_t at = text.find(from);
    CHECK(at != std::string::npos);
    writeBytes(path / file, text.replace(at, from.size(), to));
  }

 private:
  TemporaryFolder folder_;
  mutable int writes_ = 0;

 public:
  const fs::path path = folder_ / "shaders";
};

/// Shaders whose triangles have their corners rounded to 1/256 of a pixel of an image 64 wide.
class RoundedCorners : public ShaderCopy {
 public:
  RoundedCorners() {
    const std::string place = "gl_Position = clipFromWorld * vec4(positionWorld, 1.0);";
    replace("scene.vert", place,
            place + " if (gl_Position.w > 0.0) gl_Position.xy = "
                    "round(gl_Position.xy / gl_Position.w * 8192.0) / 8192.0 * gl_Position.w;");
  }
};

} // namespace lambent::test
