// Command line of the walkthrough.
#pragma once

#include "engine/scene/scene.h"
#include "gi/settings.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

struct WalkthroughOptions {
  std::filesystem::path scene; // empty only when a shot names it
  std::filesystem::path shot;  // empty: none
  std::string camera;          // by name; empty: the file's first, else a default view
  std::optional<vec3> eye, target;
  std::optional<float> fovY; // radians
  int width = 1280, height = 720;
  std::vector<std::pair<std::string, std::string>> set; // settings in the order given
  std::string buffer = "beauty";
  std::vector<LightView> lights; // added from outside
  vec3 skyRadiance{0};
  uint32_t seed = 1;
  std::optional<int> frames; // quit after so many, at 1/30 s of scene time each
  std::filesystem::path screenshot; // what the window shows at the end
};

/// Reads the command line. Returns nothing when the program is done already (--help). Throws InputError.
std::optional<WalkthroughOptions> readOptions(int argc, char** argv);

/// Folder of the bundled scenes: LAMBENT_CONTENT, else ../share/lambent/content beside the executable, else the source
/// tree's. Throws InputError naming the places when none is there.
std::filesystem::path findContentFolder();

} // namespace lambent
