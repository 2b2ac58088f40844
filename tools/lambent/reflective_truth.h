// What techniques that light from reflective shadow maps approximate.
#pragma once

#include "gi/settings.h"

namespace lambent {

/// Every texel of the maps lights every pixel, without visibility: no choice of VPLs, no cluster, no patch. Their maps
/// are what `rsm.resolution` says.
inline void lightByEveryTexel(Settings& settings) {
  applyTechnique(settings, "hisr");
  settings.gather.mode = GatherMode::Full;
  settings.rsm.tau = 0;
  settings.rsm.finest = settings.rsm.resolution;
}

} // namespace lambent
