// The passes of a frame: picture of the world as placed, with the VPLs that gi_frame_light.cpp made ready.
#include "gi/frame/gi_frame_state.h"

#include <algorithm>
#include <bit>

namespace lambent {

namespace {

/// Box of everything the camera sees: what sun and sky maps must cover. From a fixed grid of camera rays, so it is the
/// same every time; grown by a tenth for what lies between the rays.
Aabb visibleBounds(const RayQuery& rays, const SceneView& view, RayCounts& counts) {
  Aabb box;
  for (const VisiblePoint& p : findVisiblePoints(rays, view.camera, 1024, 0, 0, counts)) box.add(p.position);
  if (box.empty()) return view.boundsWorld;
  const vec3 margin = 0.05f * box.size() + 0.02f * box.diameter();
  box.lo = glm::max(box.lo - margin, view.boundsWorld.lo);
  box.hi = glm::min(box.hi + margin, view.boundsWorld.hi);
  return box;
}

Image imageOf(const CameraView& camera, std::vector<vec3> pixels) {
  Image image;
  image.width = camera.width;
  image.height = camera.height;
  image.pixels = std::move(pixels);
  return image;
}

} // namespace

void GiFrame::State::draw() {
  const SceneView& view = world.view;
  const uint64_t draws = gl::drawCount();
  results = {};
  const bool glossy = settings.gather.glossy && plan.on(EffectId::Glossy);
  const GBuffer gbuffer = gbufferPass.run({*gpuScene, view.camera, glossy});
  const DirectLight direct = drawDirect(gbuffer);
  const IndirectLight indirect = plan.on(EffectId::Indirect) ? drawIndirect(gbuffer) : IndirectLight{};
  const Picture picture = compositePass.run({gbuffer, direct, indirect, view.skyRadiance});
  for (StageTime& row : profiler.takeRows()) stats.stages.push_back(std::move(row));

  if (settings.image.exposure > 0)
    exposure = settings.image.exposure;
  else if (exposure <= 0)
    exposure = measureExposure(picture);

  results.gbuffer = gbuffer;
  results.direct = direct;
  results.indirect = indirect;
  results.picture = picture;
  results.vpls = &vpls;
  results.skyRadiance = view.skyRadiance;
  results.sceneDiameter = mapReach();
  work(EffectId::Redraw) = gl::drawCount() - draws;
  if (glossy) work(EffectId::Glossy) = work(EffectId::Redraw);
}

/// Lamps that stand elsewhere get a new map, others the part that an object moved through.
std::vector<MapJob> GiFrame::State::emitterMapJobs(std::span<const MapPose> emitters, int resolution) {
  std::vector<MapJob> jobs;
  for (uint32_t i = 0; i < emitters.size(); ++i) {
    TexelRect texels;
    if (world.view.changes.first || i >= emitterPoses.size() || emitters[i] != emitterPoses[i])
      texels = TexelRect::whole(resolution);
    else
      for (const Aabb& box : disturbance.boxes()) texels.add(texelsCovered(emitters[i], box, resolution));
    if (!texels.empty()) jobs.push_back({i, texels});
  }
  emitterPoses.assign(emitters.begin(), emitters.end());
  return jobs;
}

DirectLight GiFrame::State::drawDirect(const GBuffer& gbuffer) {
  using enum EffectId;
  const SceneView& view = world.view;
  ShadowSettings shadow = settings.shadow;
  const int width = int(std::bit_ceil(unsigned(view.camera.width)));
  if (shadow.sunResolution == 0) shadow.sunResolution = 2 * width;
  if (shadow.pointResolution == 0) shadow.pointResolution = std::max(1, width / 2);
  if (shadow.spotResolution == 0) shadow.spotResolution = width;
  const bool geometry = view.changes.geometry || view.changes.instances;
  if (receivers.empty() || view.changes.camera || geometry) receivers = visibleBounds(*rays, view, stats.raysPoints);
  const LightShadows& shadows =
      lightShadowPass.run({*gpuScene, view.lights, plan.on(Sky), lights.sky, receivers, view.boundsWorld,
                           view.changes.first, disturbance.boxes(), shadow});
  stats.lightMapsDrawn = lightShadowPass.mapsDrawn();
  work(Sky) += lightShadowPass.skyMapsDrawn();
  DirectInputs in{gbuffer, shadows, nullptr, nullptr, shadow};
  VplLights emitters;
  ParaboloidMaps maps;
  if (plan.on(Emissive)) {
    std::vector<VplLight> samples;
    std::vector<MapPose> emitterPlaces;
    for (const EmitterPatch& p : emitterPatches(lights, plan.on(SoftShadows) ? shadow.emitterSamples : 1)) {
      samples.push_back(emitterLight(p));
      emitterPlaces.push_back(emitterPose(p));
    }
    emitters = emitterBuffer.run(samples);
    const std::vector<MapJob> jobs = emitterMapJobs(emitterPlaces, shadow.emitterResolution);
    maps = emitterMapPass.run(
        {*gpuScene, rays.get(), emitterPlaces, jobs, mapReach(), shadow.emitterResolution, shadow.maker});
    in.emitters = &emitters;
    in.emitterMaps = &maps;
    stats.mapsDrawn += emitterMapPass.mapsDrawn();
    work(Emissive) += emitterMapPass.mapsDrawn();
    work(SoftShadows) = plan.on(SoftShadows) ? samples.size() : 0;
  }
  return directPass.run(in);
}

/// VPLs of the reflective maps; with visibility, where their shadow maps stand.
VplLights GiFrame::State::reflectiveLights(const ReflectiveMaps& sheet) {
  const VplSource source = settings.vpl.source;
  if (source == VplSource::Hisr) {
    stats.vplsAlive = 0;
    return vplBuffer.run({});
  }
  const VplLights shown = source == VplSource::Rsm ? reflectiveLightPass.runGrid(sheet, settings.rsm)
                                                   : reflectiveLightPass.runClusters(sheet, settings.rsm);
  stats.vplsAlive = shown.count;
  if (settings.vpl.visibility == VplVisibility::None) return shown;
  const std::vector<VplLight> lights = reflectiveLightPass.read();
  if (settings.vpl.visibility == VplVisibility::Rays) {
    vplsShown.clear();
    for (const VplLight& light : lights) vplsShown.push_back(vplOf(light));
    vplMapsOld = true;
    return shown;
  }
  mapJobs.clear();
  std::vector<MapPose> now;
  const int resolution = settings.shadow.resolution;
  const bool all = world.view.changes.first || vplMapsOld;
  for (const VplLight& light : lights) {
    const Vpl vpl = vplOf(light);
    now.push_back(vpl.alive ? MapPose{vpl.position, vpl.normal, vpl.normal} : MapPose{});
    const uint32_t slot = uint32_t(now.size() - 1);
    TexelRect texels;
    if (all || slot >= poses.size() || poses[slot] != now[slot])
      texels = TexelRect::whole(resolution);
    else
      for (const Aabb& box : disturbance.boxes()) texels.add(texelsCovered(now[slot], box, resolution));
    if (vpl.alive && !texels.empty()) mapJobs.push_back({slot, texels});
  }
  poses = std::move(now);
  vplMapsOld = false;
  return shown;
}

IndirectLight GiFrame::State::drawIndirect(const GBuffer& gbuffer) {
  const uint64_t draws = gl::drawCount();
  const bool reflective = fromReflectiveMaps(settings.vpl.source);
  ReflectiveMaps sheet;
  VplLights shown;
  if (reflective) {
    sheet = reflectiveMapPass.run(
        {*gpuScene,
         world.view.lights,
         world.view.boundsWorld,
         world.view.changes.first || reflectiveMapsOld,
         disturbance.boxes(),
         settings.rsm,
         {.clusters = settings.vpl.source != VplSource::Rsm, .patches = settings.vpl.source == VplSource::Isr}});
    reflectiveMapsOld = false;
    shown = reflectiveLights(sheet);
  }
  const bool tree = settings.vpl.source == VplSource::Hisr; // has no visibility
  if (settings.vpl.visibility == VplVisibility::Rays && !tree) {
    CpuScope scope(stats.stages, key(StageId::GatherByRays));
    const CameraView& camera = world.view.camera;
    GlossyGather glossy{world.view, {}};
    const Image irradiance = imageOf(camera, gatherByRays(*rays, camera, vplsShown, settings.gather, stats.raysGather,
                                                          gbuffer.finish ? &glossy : nullptr));
    if (!gbuffer.finish) return indirectUpload.run(irradiance);
    const Image lobes = imageOf(camera, std::move(glossy.radiance));
    return indirectUpload.run(irradiance, &lobes);
  }
  if (!reflective) shown = vplBuffer.run(vplLights);
  const LightTrees trees{sheet, settings.rsm};
  const LightTrees* cut = tree ? &trees : nullptr;
  uint32_t mapsDrawn = 0;
  const bool shadowed = settings.vpl.visibility == VplVisibility::Maps && !tree;
  if (shadowed) {
    results.vplMaps = vplMapPass.run(
        {*gpuScene, rays.get(), poses, mapJobs, mapReach(), settings.shadow.resolution, settings.shadow.maker});
    mapsDrawn = vplMapPass.mapsDrawn();
    stats.mapsDrawn += mapsDrawn;
    stats.makerTimes = vplMapPass.makerReport();
    stats.shadowMaker = stats.makerTimes.substr(0, stats.makerTimes.find(' '));
  }
  const ParaboloidMaps* maps = shadowed ? &results.vplMaps : nullptr;
  const float bias = settings.shadow.bias;
  const RawIndirect raw =
      multiresolution(settings.gather.mode)
          ? multiresPass.run({gbuffer, shown, maps, bias, settings.gather, settings.multires, settings.filter, cut})
          : gatherPass.run({gbuffer, shown, maps, bias, settings.gather, cut});
  results.raw = raw;
  if (multiresolution(settings.gather.mode)) {
    results.patches = multiresPass.patches().normalLo;
    results.patchLevels = multiresPass.patches().levels;
    if (settings.gather.mode == GatherMode::Multires || settings.gather.mode == GatherMode::MultiresInterleaved)
      stats.patches = multiresPass.patchesMarked();
  }
  FilterSettings filter = settings.filter;
  filter.on = filter.on && plan.on(EffectId::Filter);
  const uint64_t filterDraws = gl::drawCount();
  const IndirectLight indirect = filterPass.run({gbuffer, raw, filter});
  if (filter.on) work(EffectId::Filter) = gl::drawCount() - filterDraws;
  work(EffectId::Indirect) += gl::drawCount() - draws + mapsDrawn;
  return indirect;
}

} // namespace lambent
