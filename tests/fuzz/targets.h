// What is fuzzed: readers of files and text from elsewhere (gltf, compressed, settings, picture), and of files that our
// programs write and read again (shot, walk, preferences, recording, runs, state, cube). Whatever the bytes are, a reader
// gives a result that holds what it promises, or throws InputError or RunError; anything else ends the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lambent::fuzz {

struct Target {
  const char* name;
  bool (*run)(std::string_view bytes); // says whether the reader took them: more is tried from there
  std::vector<std::string> (*seeds)(); // valid inputs, with as much of the format in them as fits
  std::vector<std::string> words;      // of its language
  std::vector<std::string> probes;     // to be refused; run as they are
};
const std::vector<Target>& targets();

} // namespace lambent::fuzz
