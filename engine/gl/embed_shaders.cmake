# Writes a C++ file that holds the shaders of a folder: cmake -DFOLDER=... -DOUT=... -P embed_shaders.cmake
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
list(SORT files)
set(rows "")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} text)
  string(APPEND rows "    {\"${file}\", R\"SHADER(${text})SHADER\"},\n")
endforeach()
file(WRITE ${OUT} "// Made of shaders/ by engine/gl/embed_shaders.cmake.
#include \"engine/gl/program.h\"

namespace lambent::gl {

std::span<const BuiltInShader> builtInShaders() {
  static constexpr BuiltInShader kShaders[] = {
${rows}  };
  return kShaders;
}

} // namespace lambent::gl
")
