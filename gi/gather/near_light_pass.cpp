#include "gi/gather/near_light_pass.h"

#include "gi/near/near_light.h"

namespace lambent {

void NearLightPass::add(const GatherInputs& in, const LightTarget& target, int grid, FrameStats& stats) {
  const GatherSettings& gather = in.frame.settings.gather;
  const bool bounded = gather.disk > 0 || gather.clamp > 0;
  if (gather.near == 0 || !bounded || in.lights.list.slots.empty()) return;
  NearLight light;
  {
    const CpuScope scope(stats.stages, key(StageId::NearLight));
    light = traceNearLight({.view = in.frame.world.view,
                            .rays = in.frame.world.rays,
                            .lights = in.frame.world.lights,
                            .virtuals = in.lights.list.slots,
                            .gather = gather,
                            .casts = gather.near * (in.changes ? 2 : 1),
                            .bounces = in.frame.bounces,
                            .subsets = grid > 1,
                            .glossy = in.frame.surfaces.roughnessMetalness != nullptr,
                            .seed = in.frame.seed,
                            .frame = in.sample,
                            .frames = in.averaged ? in.frame.settings.history.frames : 1},
                           stats.raysNear);
    stats.of(EffectId::Indirect) += stats.raysNear.closest + stats.raysNear.occlusion;
  }
  if (!in.mixNear || grid == 1) {
    traced_.add(light.irradiance, light.glossy, in.frame.surfaces, target, grid);
    return;
  }
  const gl::PassScope scope = context_.scope(StageId::NearLight);
  pixels_.fit(in.frame.surfaces);
  const SurfaceLighting near = pixels_.light();
  uploadPixels(*near.irradiance, light.irradiance, in.frame.surfaces, 1);
  if (near.glossy) uploadPixels(*near.glossy, light.glossy, in.frame.surfaces, 1);
  addToSubsets(context_, in.mixNear(near), in.frame.surfaces, target);
}

} // namespace lambent
