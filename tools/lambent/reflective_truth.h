// What techniques that light from reflective shadow maps approximate.
#pragma once

#include "gi/plan/techniques.h"

namespace lambent {

/// Every texel of the maps lights every pixel, without visibility: no choice of VPLs, no cluster, no patch. Their maps
/// are what `rsm.resolution` says. As isr without clusters: the same as hisr's whole tree, two to four times as fast.
inline void lightByEveryTexel(Settings& settings) {
  applyTechnique(settings, "isr");
  settings.gather.mode = GatherMode::Full;
  settings.rsm.finest = settings.rsm.resolution;
  settings.rsm.depth = 0;
}

} // namespace lambent
