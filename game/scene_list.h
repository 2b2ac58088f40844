// Scenes that can be opened by a click.
#pragma once

#include <string>
#include <vector>

namespace lambent {

/// Files of the bundled scenes, and of those that `lambent content` has made next to them: content/NAME/NAME.gltf, by
/// name. Empty where there is no such folder.
std::vector<std::string> bundledScenes();

} // namespace lambent
