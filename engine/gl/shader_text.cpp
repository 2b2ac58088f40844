// Reads shaders, from a folder or built in, and expands #include.
#include "engine/core/error.h"
#include "engine/gl/program.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

namespace lambent::gl {

namespace fs = std::filesystem;

namespace {

fs::path& folderOfPrograms() {
  static fs::path folder;
  return folder;
}

/// The text of a built-in shader, or of a file; nothing where there is none.
std::optional<std::string> textOf(const fs::path& file, bool builtIn) {
  if (builtIn) {
    const auto shaders = builtInShaders();
    const auto found = std::ranges::find(shaders, file.generic_string(), &BuiltInShader::file);
    return found != shaders.end() ? std::optional<std::string>(found->text) : std::nullopt;
  }
  std::ifstream in(file);
  if (!in || fs::is_directory(file)) return {};
  return std::string(std::istreambuf_iterator<char>(in), {});
}

struct Expansion {
  const fs::path& folder;
  std::ostringstream out;
  std::vector<fs::path> files;
};

/// Name in `#include "name"`, else empty.
std::string includeName(const std::string& line) {
  const size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line.compare(hash, 8, "#include") != 0) return {};
  const size_t open = line.find('"', hash), close = line.find('"', open + 1);
  if (open == std::string::npos || close == std::string::npos) return {};
  return line.substr(open + 1, close - open - 1);
}

void expand(Expansion& expansion, const fs::path& file, const std::vector<std::string>& defines) {
  const size_t index = expansion.files.size();
  expansion.files.push_back(file);
  const bool builtIn = expansion.folder.empty();
  const std::optional<std::string> text = textOf(file, builtIn);
  if (!text) throw RunError("shader " + file.string() + " cannot be read");
  std::istringstream in(*text);
  std::string line;
  int cplusplusDepth = 0; // > 0 inside `#ifdef __cplusplus` of a shared header, whose includes are not for GLSL
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.rfind("#ifdef __cplusplus", 0) == 0 || (cplusplusDepth > 0 && line.rfind("#if", 0) == 0))
      ++cplusplusDepth;
    else if (cplusplusDepth > 0 &&
             (line.rfind("#endif", 0) == 0 || (cplusplusDepth == 1 && line.rfind("#else", 0) == 0)))
      --cplusplusDepth;
    if (line.rfind("#version", 0) == 0) {
      expansion.out << line << '\n';
      for (const std::string& define : defines) expansion.out << "#define " << define << '\n';
      expansion.out << "#line " << number + 1 << ' ' << index << '\n';
      continue;
    }
    const std::string name = includeName(line);
    if (name.empty() || cplusplusDepth > 0) {
      expansion.out << (name.empty() ? line : "") << '\n';
      continue;
    }
    fs::path target = (file.parent_path() / name).lexically_normal();
    if (!textOf(target, builtIn)) target = (expansion.folder / name).lexically_normal();
    if (!textOf(target, builtIn))
      throw RunError("shader " + file.string() + ":" + std::to_string(number) + ": no file \"" + name +
                     "\" next to it or in " + (builtIn ? "the built-in shaders" : expansion.folder.string()));
    // Each file goes in once: shared headers include one another, and GLSL has no use for a second copy.
    if (std::find(expansion.files.begin(), expansion.files.end(), target) == expansion.files.end()) {
      expansion.out << "#line 1 " << expansion.files.size() << '\n';
      expand(expansion, target, {});
    }
    expansion.out << "#line " << number + 1 << ' ' << index << '\n';
  }
}

} // namespace

ShaderText loadShader(const fs::path& folder, const std::string& file, const std::vector<std::string>& defines) {
  Expansion expansion{folder, {}, {}};
  expand(expansion, (folder / file).lexically_normal(), defines);
  return {expansion.out.str(), std::move(expansion.files)};
}

void setShaderFolder(const fs::path& folder) { folderOfPrograms() = folder; }
const fs::path& shaderFolder() { return folderOfPrograms(); }

} // namespace lambent::gl
