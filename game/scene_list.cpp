#include "game/scene_list.h"

#include "engine/core/error.h"
#include "tools/launch/launch.h"

#include <algorithm>

namespace lambent {

namespace fs = std::filesystem;

std::vector<std::string> bundledScenes() {
  std::vector<std::string> scenes;
  try {
    std::error_code failure;
    for (const auto& entry : fs::directory_iterator(findContentFolder(), failure)) {
      const fs::path file = entry.path() / entry.path().filename().replace_extension(".gltf");
      if (std::error_code none; fs::exists(file, none)) scenes.push_back(file.string());
    }
  } catch (const InputError&) { // there is no folder; files can still be dropped
  }
  std::ranges::sort(scenes);
  return scenes;
}

} // namespace lambent
