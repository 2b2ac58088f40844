// Scenes that the program can make by itself, so that the repository needs no downloads: `lambent content [NAME...]`.
// A recipe writes NAME.gltf, NAME.bin and small PNG textures into one folder. The same bytes come out on every run:
// geometry is computed in double precision and rounded to a fixed grid before it is stored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lambent {

/// What a recipe wrote.
struct GeneratedScene {
  std::filesystem::path file;       // the .gltf to open
  uint64_t triangles = 0;           // as placed in the scene: every instance of a mesh counts
  uint64_t bytes = 0;               // of all files together
  std::vector<std::string> written; // file names inside the folder, in the order they were written
};

struct ContentRecipe {
  std::string name;        // also the default folder and file stem: content/NAME/NAME.gltf
  std::string description; // one line
  bool bundled = false;    // kept in the repository; the others are made on demand, as they are large
  /// Writes all files into `folder` (made when missing), each to a temporary name first. Throws RunError when the
  /// folder cannot be written.
  std::function<GeneratedScene(const std::filesystem::path& folder)> write;
};

/// All recipes, the default scene first.
const std::vector<ContentRecipe>& contentRecipes();

} // namespace lambent
