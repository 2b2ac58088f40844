// Lights of reflective shadow maps (papers 2 and 3), drawn on the GPU.
#include "gi/reflective/reflective_source.h"

#include "gi/lighting/dirty_region.h"

namespace lambent {

VirtualLights ReflectiveSource::run(const SourceInputs& in, FrameStats& stats) {
  if (!in.plan.on(EffectId::Redraw)) return {};
  const World& world = in.world;
  const uint64_t draws = gl::counts().draws;
  const SourceRow& row = rowOf(in.settings.vpl.source);
  sheet_ = mapPass_.run({world.gpu,
                         world.view.lights,
                         world.view.boundsWorld,
                         world.view.changes.first || old_,
                         world.moved.boxes(),
                         in.settings.rsm,
                         {.clusters = row.clusters, .patches = row.clusters && !row.tree}});
  old_ = false;
  VirtualLights lights;
  if (row.tree) {
    trees_.emplace(LightTrees{sheet_, in.settings.rsm});
    lights.trees = &*trees_;
  } else {
    lights.packed =
        row.clusters ? lightPass_.runClusters(sheet_, in.settings.rsm) : lightPass_.runGrid(sheet_, in.settings.rsm);
    lights.alive = lights.packed.count;
    if (in.settings.vpl.visibility != VplVisibility::None || rowOf(in.settings.gather.mode).volume) { // made on the CPU
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
