// What the forms of `lambent accuracy` share.
#pragma once

#include "tools/lambent/commands.h"

#include <string>

namespace lambent {

struct AccuracyOptions {
  LaunchOptions launch;
  OutputOptions output;
  int slots = 64, points = 1024;
  std::string curve; // empty: shadow maps of virtual lights
};

/// Error against threshold: "patches" of the picture (paper 3, fig. 9) or "clusters" of the lights (fig. 13).
void accuracyCurve(const AccuracyOptions& options);

} // namespace lambent
