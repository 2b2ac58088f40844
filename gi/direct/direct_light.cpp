#include "gi/direct/direct_light.h"

#include "gi/gather/draw_gather.h"
#include "gi/visibility/map_keeper.h"
#include "gi/vpl/disturbance.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <bit>

namespace lambent {

namespace {

/// Box of everything the camera sees. From a fixed grid of camera rays, so it is the same every time; grown by a tenth
/// for what lies between the rays.
Aabb visibleBounds(const World& world, RayCounts& counts) {
  const Aabb& scene = world.view.boundsWorld;
  Aabb box;
  for (const VisiblePoint& p : findVisiblePoints(world.rays, world.view.camera, 1024, 0, 0, counts))
    box.add(p.position);
  if (box.empty()) return scene;
  const vec3 margin = 0.05f * box.size() + 0.02f * box.diameter();
  box.lo = glm::max(box.lo - margin, scene.lo);
  box.hi = glm::min(box.hi + margin, scene.hi);
  return box;
}

/// With the resolutions that follow the picture filled in.
ShadowSettings resolved(ShadowSettings shadow, int pictureWidth) {
  const int width = int(std::bit_ceil(unsigned(pictureWidth)));
  if (shadow.sunResolution == 0) shadow.sunResolution = 2 * width;
  if (shadow.pointResolution == 0) shadow.pointResolution = std::max(1, width / 2);
  if (shadow.spotResolution == 0) shadow.spotResolution = width;
  return shadow;
}

} // namespace

DirectLight::DirectLight(PassContext context)
    : context_(context), shadows_(context), emitters_(context, StageId::Emitters),
      emitterMaps_(context, StageId::EmitterMaps), compare_("direct/compare") {
  const GLuint sampler = compare_.name();
  glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL); // lit where reference ≤ stored
}

LightOnSurfaces DirectLight::run(const DirectInputs& in, FrameStats& stats) {
  const World& world = in.world;
  const ShadowSettings shadow = resolved(in.shadow, world.view.camera.width);
  fitReceivers(in, stats);
  const LightShadows& shadows =
      shadows_.run({world.gpu, world.view.lights, in.plan.on(EffectId::Sky), world.lights.sky, receivers_,
                    world.view.boundsWorld, world.view.changes.first, world.moved.boxes(), shadow});
  stats.lightMapsDrawn = shadows_.mapsDrawn();
  stats.of(EffectId::Sky) += shadows_.skyMapsDrawn();

  VirtualLights lights;
  ParaboloidMaps maps;
  std::vector<VirtualLight> samples;
  if (in.plan.on(EffectId::Emissive)) {
    for (const EmitterPatch& p :
         emitterPatches(world.lights, in.plan.on(EffectId::SoftShadows) ? shadow.emitterSamples : 1))
      samples.push_back(lightOf(p));
    lights.packed = emitters_.run(samples);
    std::vector<MapPose> poses;
    for (const VirtualLight& s : samples) poses.push_back(s.pose(in.world.rays.grain()));
    const std::vector<MapJob> jobs = jobsAtOnce(poses, emitterPoses_, samples, world.moved.boxes(),
                                                world.view.changes.first, shadow.emitterResolution);
    emitterPoses_ = std::move(poses);
    maps = emitterMaps_.run(
        {world.gpu, &world.rays, emitterPoses_, jobs, world.reach, shadow.emitterResolution, shadow.maker});
    stats.mapsDrawn += emitterMaps_.mapsDrawn();
    stats.of(EffectId::Emissive) += emitterMaps_.mapsDrawn();
    stats.of(EffectId::SoftShadows) = in.plan.on(EffectId::SoftShadows) ? samples.size() : 0;
  }

  const gl::PassScope scope = context_.scope(StageId::Direct);
  target_.fit(in.surfaces);
  target_.clear();
  for (const LightBlock& block : shadows.blocks) {
    const char* kind = block.kind == LightKind::Cube   ? "CUBE_MAPS"
                       : block.kind == LightKind::Spot ? "SPOT_MAPS"
                                                       : "SUN_MAPS";
    std::vector<std::string> defines = bindSurfaces(in.surfaces);
    defines.push_back(kind);
    const gl::Program& program = context_.programs.get({.fragment = "direct.frag", .defines = std::move(defines)});
    program.use();
    program.set("lightCount", block.count);
    block.lights.bindUniform(1);
    block.maps.bind(2);
    gl::PipelineState{.add = true, .width = in.surfaces.width, .height = in.surfaces.height}.apply();
    gl::drawFullscreen();
  }
  if (lights.packed.count > 0)
    drawGather(context_.programs, target_.framebuffer(),
               {.surfaces = in.surfaces,
                .seen = {lights, &maps},
                .smoothShadows = &compare_,
                .areas = gatherAreas(in.surfaces, 1),
                .addToTarget = true,
                .biasTexels = 1.5f}); // bilinear comparison reaches half a texel farther than one
  return target_.light();
}

/// Nothing needs the box where no map is fitted to it.
void DirectLight::fitReceivers(const DirectInputs& in, FrameStats& stats) {
  const SceneView& view = in.world.view;
  const bool fitted =
      in.plan.on(EffectId::Sky) || std::any_of(view.lights.begin(), view.lights.end(),
                                               [](const auto& l) { return l.type == LightType::Directional; });
  if (!fitted) {
    receivers_ = {};
    return;
  }
  if (receivers_.empty() || view.changes.camera || view.changes.geometry || view.changes.instances)
    receivers_ = visibleBounds(in.world, stats.raysPoints);
}

} // namespace lambent
