// Shader programs from files: #include, variants by defines, hot reload that keeps the last good program.
#pragma once

#include "engine/core/math.h"
#include "engine/gl/objects.h"

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <unordered_map>

namespace lambent::gl {

/// Files relative to the shader folder, and macros ("NAME" or "NAME value") that select the variant.
struct ProgramDesc {
  std::string vertex = "fullscreen.vert";
  std::string fragment = {};
  std::vector<std::string> defines = {};
  std::string geometry = {};              // none if empty
  std::vector<std::string> captured = {}; // outputs for transform feedback, interleaved; then `fragment` may be empty
  std::string compute = {};               // alone: the others are then not looked at

  std::string key() const;
};

class Program {
 public:
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  GLuint name() const { return name_; }
  void use() const;

  // Uniforms by name; a name that the variant does not have is ignored (the compiler may have removed it).
  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const vec2& value) const;
  void set(const char* uniform, const vec3& value) const;
  void set(const char* uniform, const vec4& value) const;
  void set(const char* uniform, const glm::ivec2& value) const;
  void set(const char* uniform, const mat4& value) const;

 private:
  friend class ProgramCache;
  Program() = default;
  int location(const char* uniform) const;

  struct SourceFile {
    std::filesystem::path path;
    std::filesystem::file_time_type written;
  };
  ProgramDesc desc_;
  GLuint name_ = 0;
  std::vector<SourceFile> files_; // all that went in, with includes
  mutable std::unordered_map<std::string, int> locations_;
};

/// Text of a shader with its includes expanded once each; #line directives number the files in the order of `files`.
struct ShaderText {
  std::string text;
  std::vector<std::filesystem::path> files;
};
/// `#include "name"` is looked for next to the including file, then in `folder`; an empty folder means the shaders that
/// this was built with. `defines` go below #version. Throws RunError naming file and line of an include that is not
/// there.
ShaderText loadShader(const std::filesystem::path& folder, const std::string& file,
                      const std::vector<std::string>& defines);

/// A shader that this was built with: its path in the folder shaders/, and its text.
struct BuiltInShader {
  std::string_view file, text;
};
std::span<const BuiltInShader> builtInShaders(); // ascending by file

/// Where new caches read shaders, for programs to choose when they start; empty, as at first: the built-in ones.
void setShaderFolder(const std::filesystem::path& folder);
const std::filesystem::path& shaderFolder();

/// Programs of one context, compiled when first asked for. References stay valid for the life of the cache.
/// LAMBENT_DUMP_SHADERS=FOLDER has every variant that compiles written there as the compiler got it, so that other
/// compilers can be asked (tests/cli/shaders): PROGRAM-FILE.vert, .geom, .frag and .comp, with a number for the
/// program.
class ProgramCache {
 public:
  explicit ProgramCache(std::filesystem::path folder = shaderFolder()) : folder_(std::move(folder)) {}

  /// Throws RunError with the compiler's log when the program has never compiled.
  const Program& get(const ProgramDesc& desc);

  /// Recompiles what changed on disk; nothing where shaders are built in. A program that fails keeps its last good
  /// version. Returns one message per program touched: "reloaded gather.frag", or the file and the compiler's log.
  std::vector<std::string> reloadChanged();

  const std::filesystem::path& folder() const { return folder_; }

 private:
  void build(Program& program) const;
  void dump(const ProgramDesc& desc, const std::vector<std::pair<GLenum, ShaderText>>& sources) const;

  std::filesystem::path folder_;
  std::map<std::string, std::unique_ptr<Program>> programs_;
};

} // namespace lambent::gl
