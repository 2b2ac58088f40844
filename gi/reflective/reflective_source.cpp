// Lights of reflective shadow maps (papers 2 and 3), drawn on the GPU.
#include "gi/reflective/reflective_source.h"

#include "gi/contract/figures.h"
#include "gi/lighting/dirty_region.h"

namespace lambent {

VirtualLights ReflectiveSource::run(const FrameWorld& in, const Needs& needs, FrameStats& stats) {
  if (!in.plan.on(EffectId::Redraw)) return {};
  const World& world = in.world;
  const uint64_t draws = gl::counts().draws;
  const bool clusters = kind_ != ReflectiveLights::Grid, trees = kind_ == ReflectiveLights::Trees;
  sheet_ = mapPass_.run({world.gpu,
                         world.view.lights,
                         world.view.boundsWorld,
                         world.view.changes.first || old_,
                         world.moved.boxes(),
                         in.settings.rsm,
                         {.clusters = clusters, .patches = clusters && !trees}});
  old_ = false;
  VirtualLights lights;
  if (trees) {
    trees_.emplace(LightTrees{sheet_, in.settings.rsm});
    lights.trees = &*trees_;
  } else {
    lights.packed =
        clusters ? lightPass_.runClusters(sheet_, in.settings.rsm) : lightPass_.runGrid(sheet_, in.settings.rsm);
    lights.alive = lights.packed.count;
    if (needs.lightsOnCpu) {
      if (sheet_.changed || shown_.empty()) {
        shown_.clear();
        for (const VplLight& light : lightPass_.read()) shown_.push_back(unpack(light));
      }
      lights.slots = shown_;
    } else {
      shown_.clear();
    }
  }
  stats.of(EffectId::Indirect) += gl::counts().draws - draws;
  return lights;
}

} // namespace lambent
