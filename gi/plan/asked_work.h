// How much more than the defaults settings ask for.
#pragma once

#include "gi/plan/settings.h"

#include <string>

namespace lambent {

struct AskedWork {
  double times = 1;  // of the time or the memory of the defaults, whichever grows faster; 1: no more than these
  std::string names; // of the settings that make it so
};
/// An estimate by what settings count: lights, paths, rays and warm-up multiply each other, as do the lights or samples
/// and the texels of maps. Of these products the largest.
AskedWork workOf(const Settings& settings);

} // namespace lambent
