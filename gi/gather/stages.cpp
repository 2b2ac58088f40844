#include "gi/gather/stages.h"

#include "engine/core/error.h"
#include "gi/plan/techniques.h"

namespace lambent {

IndirectStage& IndirectStages::of(const Settings& settings) {
  const GatherRow& gather = rowOf(settings.gather.mode);
  const bool rays = settings.vpl.visibility == VplVisibility::Rays;
  const Make make = settings.own     ? settings.own->make
                    : rays           ? makeRayGather
                    : gather.volume  ? makeVolumeGather
                    : gather.stored  ? makeCubeGather
                    : gather.splats  ? makeSplatGather
                    : gather.patches ? makePatchGather
                                     : makePixelGather;
  for (const auto& [by, stage] : made_)
    if (by == make) return *stage;
  made_.emplace_back(make, make(context_));
  return *made_.back().second;
}

} // namespace lambent
