#include "gi/direct/emitter_shadows.h"

#include "gi/lighting/dirty_region.h"
#include "gi/lighting/light_set.h"
#include "gi/visibility/shadow_map_cache.h"
#include "shaders/shared/paraboloid.h"

#include <algorithm>

namespace lambent {

namespace {

LightRecord recordOf(const VirtualLight& sample, int layer, const ParaboloidMaps& maps) {
  LightRecord record;
  record.positionRange = vec4(sample.position, sample.area);
  record.directionTexel = vec4(sample.normal, 2.0f / float(maps.resolution));
  record.intensityLayer = vec4(sample.radiance * sample.area, float(layer));
  record.coneNear = vec4(0, 0, maps.farDistance, 0);
  mat3 frame;
  basisAround(sample.normal, frame[0], frame[1]);
  frame[2] = sample.normal;
  record.mapFromWorld = mat4(glm::transpose(frame));
  return record;
}

} // namespace

std::vector<LightBlock> EmitterShadowPass::run(const World& world, const ShadowSettings& shadow, int samples,
                                               FrameStats& stats) {
  std::vector<VirtualLight> lights;
  std::vector<MapPose> poses;
  for (const EmitterPatch& p : emitterPatches(world.lights, samples)) {
    lights.push_back(lightOf(p));
    poses.push_back(lights.back().pose(world.rays.rayEpsilon()));
  }
  const std::vector<MapJob> jobs =
      jobsAtOnce(poses, poses_, lights, world.moved.boxes(), world.view.changes.first, shadow.emitterResolution);
  poses_ = std::move(poses);
  const bool checkered = shadow.rays && world.gpu.blends();
  const ParaboloidMaps maps = maps_.run({.scene = world.gpu,
                                         .rays = &world.rays,
                                         .poses = poses_,
                                         .jobs = jobs,
                                         .farDistance = world.farDistance,
                                         .resolution = shadow.emitterResolution,
                                         .maker = checkered ? ShadowMaker::Rays : shadow.maker,
                                         .checkered = checkered});
  stats.mapsDrawn += maps_.mapsDrawn();

  const gl::PassScope scope = context_.scope(StageId::Emitters);
  std::vector<LightBlock> out;
  if (const size_t needed = (lights.size() + kLightsPerBlock - 1) / kLightsPerBlock; blocks_.size() < needed)
    blocks_.resize(needed); // at once: `out` points into it
  for (size_t first = 0; first < lights.size(); first += kLightsPerBlock) {
    std::vector<LightRecord> records;
    for (size_t i = first; i < std::min(first + kLightsPerBlock, lights.size()); ++i)
      records.push_back(recordOf(lights[i], int(i) % kLayersPerArray, maps));
    LightRecords& block = blocks_[out.size()];
    block.hold(std::move(records), changedLights_);
    out.push_back({MapKind::Emitter, &maps.arrays[first / kLayersPerArray], &block.buffer(), block.held()});
  }
  return out;
}

} // namespace lambent
