// What a result depends on: work that was interrupted goes on under the same conditions only.
#pragma once

#include "tools/launch/launch.h"

namespace lambent {

/// Hash of the program with its shaders, of the files of scene and shot, of what was opened and how, and of `more`; 16
/// hexadecimal digits. Not of pictures and buffers beside a scene's file.
std::string conditionsOf(const LaunchContext& stage, const LaunchOptions& options, const std::string& more);

} // namespace lambent
