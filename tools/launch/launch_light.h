// Lights of the command line, and those that a scene without any gets.
#pragma once

#include "tools/launch/launch.h"

namespace lambent {

/// Three finite numbers with commas between them. Throws InputError.
dvec3 threeNumbers(const std::string& option, const std::string& text);

/// --sun, --point, --sky and --daylight, which takes the place of the scene's own sky and suns. Throws InputError.
void addGivenLights(LaunchContext& stage, const LaunchOptions& options);

/// A clear sky and its sun for a scene that has no light, or where what shines hardly lights it; a lamp by the camera
/// where no sky reaches it. `view`: of the scene as it is.
void lightWhatIsDark(LaunchContext& stage, const LaunchOptions& options, const SceneView& view);

} // namespace lambent
