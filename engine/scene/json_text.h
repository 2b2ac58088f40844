// What parsers of JSON let pass: text nested so deeply that they run out of stack, keys given twice, of which one would
// silently win, and negative numbers where they read none.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lambent {

struct JsonText {
  std::vector<std::string> uris; // values of keys "uri" that are not data themselves
  size_t materials = 0;          // objects in the list of that name of the outermost object
  size_t textureParts = 0;       // the same of samplers, textures and images
};
/// Checks the text. Throws InputError. Whether it is JSON at all is left to the parser.
JsonText checkJson(const std::filesystem::path& file, std::string_view text);

/// What a parser says is wrong with JSON, without the name that it gives to its exception.
std::string reasonOf(std::string message);

} // namespace lambent
