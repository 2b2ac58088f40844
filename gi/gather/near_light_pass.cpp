#include "gi/gather/near_light_pass.h"

#include "gi/near/near_light.h"

namespace lambent {

void NearLightPass::add(const IndirectInputs& in, const LightTarget& target, int grid, FrameStats& stats) {
  const GatherSettings& gather = in.settings.gather;
  const bool bounded = gather.disk > 0 || gather.clamp > 0;
  if (gather.near == 0 || !bounded || in.seen.lights.slots.empty()) return;
  NearLight light;
  {
    const CpuScope scope(stats.stages, key(StageId::NearLight));
    light = traceNearLight({.view = in.world.view,
                            .rays = in.world.rays,
                            .lights = in.world.lights,
                            .virtuals = in.seen.lights.slots,
                            .gather = gather,
                            .casts = gather.near * (in.changes ? 2 : 1),
                            .bounces = in.bounces,
                            .subsets = grid > 1,
                            .glossy = in.surfaces.roughnessMetalness != nullptr,
                            .seed = in.seed,
                            .picture = in.picture,
                            .pictures = in.averaged ? in.settings.history.frames : 1},
                           stats.raysNear);
    stats.of(EffectId::Indirect) += stats.raysNear.closest + stats.raysNear.occlusion;
  }
  traced_.add(light.irradiance, light.glossy, in.surfaces, target, grid);
}

} // namespace lambent
