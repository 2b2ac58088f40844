#include "gi/gi_frame.h"

#include "engine/core/error.h"
#include "engine/core/text.h"
#include "engine/trace/embree_query.h"
#include "gi/render/map_schedule.h"
#include "gi/render/passes.h"
#include "gi/vpl/sources.h"

#include <algorithm>
#include <bit>

namespace lambent {

namespace {

using Clock = std::chrono::steady_clock;

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

struct GiFrame::State {
  Settings settings;
  uint32_t seed;

  gl::ProgramCache programs;
  gl::GpuProfiler profiler;
  PassContext context{programs, profiler};
  GBufferPass gbufferPass{context};
  LightShadowPass lightShadowPass{context};
  ParaboloidMapPass emitterMapPass{context, "emitter maps"};
  VplLightBuffer emitterBuffer{context, "emitters"};
  DirectPass directPass{context};
  ParaboloidMapPass vplMapPass{context, "vpl maps"};
  VplLightBuffer vplBuffer{context, "vpls"};
  GatherPass gatherPass{context};
  FilterPass filterPass{context};
  IndirectUpload indirectUpload{context};
  CompositePass compositePass{context};
  mutable DisplayPass displayPass{context};

  const SceneAssets* assets = nullptr;
  std::unique_ptr<GpuScene> gpuScene;
  std::unique_ptr<EmbreeQuery> rays;
  VplSet vpls;
  std::vector<VplLight> lights;
  MapSchedule mapSchedule;
  std::vector<MapPose> emitterPoses;
  float farDistance = 0;
  Aabb receivers; // see visibleBounds
  bool calibrated = false;
  float exposure = 0;

  FrameResults results;
  FrameStats stats;

  State(const Settings& s, uint32_t seed_) : settings(s), seed(seed_) {}

  void prepare(const SceneView& view);
  VplChanges moveVpls(const SceneView& view, const LightSet& lights, const std::function<void(int, int)>& progress);
  float mapReach(const SceneView& view);
  std::vector<MapJob> mapsToDraw(const SceneView& view, const VplChanges& changes, std::span<const MapPose> poses);
  std::vector<MapJob> emitterMapJobs(const SceneView& view, std::span<const MapPose> poses, int resolution);
  DirectLight drawDirect(const SceneView& view, const EffectPlan& plan, const LightSet& lights, const GBuffer& gbuffer);
  IndirectLight drawIndirect(const SceneView& view, const VplChanges& changes, const GBuffer& gbuffer);
  void takeGpuRows() {
    for (StageTime& row : profiler.takeRows()) stats.stages.push_back(std::move(row));
  }
};

GiFrame::GiFrame(const Settings& settings, uint32_t seed) : state_(std::make_unique<State>(settings, seed)) {}
GiFrame::~GiFrame() = default;

// The frame -----------------------------------------------------------------------------------------------------------

const FrameStats& GiFrame::run(const SceneView& view, const std::function<void(int, int)>& progress) {
  State& s = *state_;
  const auto begin = Clock::now();
  s.prepare(view);

  const EffectPlan plan = planEffects(view, s.settings);
  const LightSet lights = collectLights(view);
  const VplChanges changes = plan.indirect ? s.moveVpls(view, lights, progress) : VplChanges{};
  const GBuffer gbuffer = s.gbufferPass.run({*s.gpuScene, view.camera});
  const DirectLight direct = s.drawDirect(view, plan, lights, gbuffer);
  const IndirectLight indirect = plan.indirect ? s.drawIndirect(view, changes, gbuffer) : IndirectLight{};
  const Picture picture = s.compositePass.run({gbuffer, direct, indirect, view.skyRadiance});
  s.takeGpuRows();

  if (s.settings.image.exposure > 0)
    s.exposure = s.settings.image.exposure;
  else if (s.exposure <= 0)
    s.exposure = measureExposure(picture);

  s.results.gbuffer = gbuffer;
  s.results.direct = direct;
  s.results.indirect = indirect;
  s.results.picture = picture;
  s.results.vpls = &s.vpls;
  s.results.skyRadiance = view.skyRadiance;
  s.results.sceneDiameter = s.farDistance;
  s.stats.vplsKept = changes.kept;
  s.stats.vplsMoved = uint32_t(changes.movedSlots.size());
  s.stats.vplsInvalid = changes.invalid;
  s.stats.vplsAlive = changes.alive;
  s.stats.burst = changes.burst;
  s.stats.plan = plan.oneLine();
  s.stats.wallMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return s.stats;
}

/// Takes over what changed in the scene.
void GiFrame::State::prepare(const SceneView& view) {
  CHECK(view.assets != nullptr);
  const uint32_t frame = stats.frame + (assets ? 1 : 0);
  stats = {};
  stats.frame = frame;
  results = {};
  if (!calibrated) {
    if (settings.debug.timing == TimingMode::Auto)
      profiler.calibrate();
    else
      profiler.choose(settings.debug.timing == TimingMode::Queries ? gl::Timing::Queries : gl::Timing::Finish);
    calibrated = true;
  }
  stats.timing = profiler.timing() == gl::Timing::Finish ? "finish" : "queries";
  {
    CpuScope scope(stats.stages, "scene");
    if (assets != view.assets) {
      assets = view.assets;
      gpuScene = std::make_unique<GpuScene>(programs, *assets);
      rays = std::make_unique<EmbreeQuery>(*assets);
      vpls = {};
    }
    rays->update(view);
    gpuScene->place(view.instances);
  }
}

VplChanges GiFrame::State::moveVpls(const SceneView& view, const LightSet& lightSet,
                                    const std::function<void(int, int)>& progress) {
  VplUpdateLog log;
  const VplChanges changes =
      placeVpls(settings.vpl.source, vpls, {view, *rays, lightSet, settings.smc, seed, settings.vpl}, log, progress);
  for (StageTime& row : log.stages) stats.stages.push_back(std::move(row));
  stats.raysPoints = log.points;
  stats.raysValidation = log.validation;
  stats.raysCandidates = log.candidates;
  stats.raysRadiosity = log.radiosity;
  stats.raysCells = log.cells;
  stats.vplsRelit = log.relit;
  return changes;
}

/// Lamps that stand elsewhere get a new map, others the part that an object moved through.
std::vector<MapJob> GiFrame::State::emitterMapJobs(const SceneView& view, std::span<const MapPose> poses,
                                                   int resolution) {
  const Disturbance moved(view);
  std::vector<MapJob> jobs;
  for (uint32_t i = 0; i < poses.size(); ++i) {
    TexelRect texels;
    if (view.changes.first || i >= emitterPoses.size() || poses[i] != emitterPoses[i])
      texels = TexelRect::whole(resolution);
    else
      for (const Aabb& box : moved.boxes()) texels.add(texelsCovered(poses[i], box, resolution));
    if (!texels.empty()) jobs.push_back({i, texels});
  }
  emitterPoses.assign(poses.begin(), poses.end());
  return jobs;
}

DirectLight GiFrame::State::drawDirect(const SceneView& view, const EffectPlan& plan, const LightSet& lightSet,
                                       const GBuffer& gbuffer) {
  ShadowSettings shadow = settings.shadow;
  const int width = int(std::bit_ceil(unsigned(view.camera.width)));
  if (shadow.sunResolution == 0) shadow.sunResolution = 2 * width;
  if (shadow.pointResolution == 0) shadow.pointResolution = std::max(1, width / 2);
  if (shadow.spotResolution == 0) shadow.spotResolution = width;
  if (view.changes.first || view.changes.camera || view.changes.geometry || view.changes.instances)
    receivers = visibleBounds(*rays, view, stats.raysPoints);
  const LightShadows& shadows =
      lightShadowPass.run({*gpuScene, view.lights, view.skyRadiance, receivers, view.boundsWorld, view.changes.geometry || view.changes.instances, shadow});
  DirectInputs in{gbuffer, shadows, nullptr, nullptr, shadow};
  VplLights emitters;
  ParaboloidMaps maps;
  if (plan.emissiveSurfaces) {
    std::vector<VplLight> samples;
    std::vector<MapPose> poses;
    for (const EmitterPatch& p : emitterPatches(lightSet, shadow.emitterSamples)) {
      samples.push_back(emitterLight(p));
      poses.push_back(emitterPose(p));
    }
    emitters = emitterBuffer.run(samples);
    const std::vector<MapJob> jobs = emitterMapJobs(view, poses, shadow.emitterResolution);
    maps = emitterMapPass.run(
        {*gpuScene, rays.get(), poses, jobs, mapReach(view), shadow.emitterResolution, shadow.maker});
    in.emitters = &emitters;
    in.emitterMaps = &maps;
    stats.mapsDrawn += emitterMapPass.mapsDrawn();
  }
  return directPass.run(in);
}

/// Distance that stands for 1 in the maps. All are drawn anew when it changes, so it leaves room to grow.
float GiFrame::State::mapReach(const SceneView& view) {
  const float wanted = view.boundsWorld.diameter();
  if (wanted > farDistance || wanted < 0.5f * farDistance)
    farDistance = view.changes.geometry && farDistance > 0 ? 1.25f * wanted : wanted;
  return farDistance;
}

/// Maps of lights that stand elsewhere, and as far as the budget goes of those that see where objects moved.
std::vector<MapJob> GiFrame::State::mapsToDraw(const SceneView& view, const VplChanges& changes,
                                               std::span<const MapPose> poses) {
  const int resolution = settings.shadow.resolution;
  std::vector<float> brightness;
  // A light that brings nothing now may do so later, so its map is not given up.
  for (const Vpl& v : vpls.slots) brightness.push_back(v.alive ? std::max(v.intensity(), 1e-20f) : 0);
  if (view.changes.geometry || view.changes.instances)
    mapSchedule.disturb(poses, brightness, Disturbance(view), *rays, resolution, settings.shadow.motionRays, seed,
                        stats.frame, stats.raysMapTests);
  const int64_t texels = int64_t(settings.shadow.refresh) * resolution * resolution;
  std::vector<MapJob> jobs = mapSchedule.take(changes.movedSlots, brightness, resolution, texels);
  stats.mapsWaiting = uint32_t(mapSchedule.waiting());
  return jobs;
}

IndirectLight GiFrame::State::drawIndirect(const SceneView& view, const VplChanges& changes, const GBuffer& gbuffer) {
  if (settings.smc.visibility == VplVisibility::Rays) {
    CpuScope scope(stats.stages, "gather by rays");
    return indirectUpload.run(
        imageOf(view.camera, gatherByRays(*rays, view.camera, vpls.slots, settings.gather, stats.raysGather)));
  }
  lights.clear();
  for (const Vpl& v : vpls.slots) lights.push_back(vplLight(v));
  const VplLights vplLights = vplBuffer.run(lights);
  const std::vector<MapPose> poses = mapPoses(vpls);
  ParaboloidMapInputs in{
      *gpuScene, rays.get(), poses, {}, mapReach(view), settings.shadow.resolution, settings.shadow.maker};
  if (vplMapPass.drawsAllAnew(in)) mapSchedule.clear();
  const std::vector<MapJob> jobs = mapsToDraw(view, changes, poses);
  in.jobs = jobs;
  const ParaboloidMaps maps = vplMapPass.run(in);
  stats.mapsDrawn += vplMapPass.mapsDrawn();
  stats.shadowMaker = vplMapPass.makerReport();
  const RawIndirect raw = gatherPass.run({gbuffer, vplLights, &maps, settings.shadow.bias, settings.gather});
  results.raw = raw;
  results.vplMaps = maps;
  return filterPass.run({gbuffer, raw, settings.filter});
}

// Looking at it
// ---------------------------------------------------------------------------------------------------------

namespace {
const std::vector<std::string> kBufferNames = {"beauty",     "direct", "indirect",    "irradiance",
                                               "albedo",     "normal", "depth",       "emission",
                                               "unfiltered", "vpls",   "shadow-maps", "nan"};
}

const std::vector<std::string>& bufferNames() { return kBufferNames; }

Buffer bufferByName(const std::string& name) {
  for (size_t i = 0; i < kBufferNames.size(); ++i)
    if (kBufferNames[i] == name) return Buffer(i);
  const std::string near = nearestName(name, kBufferNames);
  throw InputError("--buffer " + name,
                   "no such buffer (" + (near.empty() ? "beauty, direct, …" : "did you mean " + near + "?") + ")");
}

Image GiFrame::read(Buffer buffer) const { return readBuffer(buffer, state_->results); }

Image8 GiFrame::readDisplay(Buffer buffer) const {
  state_->displayPass.run(buffer, state_->results, state_->exposure, state_->settings.debug.nan);
  return state_->displayPass.read();
}

void GiFrame::present(Buffer buffer, uint32_t framebuffer, int width, int height) const {
  state_->displayPass.run(buffer, state_->results, state_->exposure, state_->settings.debug.nan);
  state_->displayPass.present(framebuffer, width, height);
}

ShadowAgreement GiFrame::compareShadowMaps(const SceneView& view, int slots, int points,
                                           const std::function<void(int, int)>& progress) {
  State& s = *state_;
  const std::vector<MapPose> poses = mapPoses(s.vpls);
  const ParaboloidMapInputs maps{*s.gpuScene,
                                 s.rays.get(),
                                 poses,
                                 {},
                                 view.boundsWorld.diameter(),
                                 s.settings.shadow.resolution,
                                 s.settings.shadow.maker};
  return measureShadowAgreement(s.vplMapPass, maps, *s.rays, view.camera, s.vpls, s.settings, slots, points, progress);
}

std::vector<std::string> GiFrame::reloadShaders() { return state_->programs.reloadChanged(); }

Settings& GiFrame::settings() { return state_->settings; }
const VplSet& GiFrame::vpls() const { return state_->vpls; }
const RayQuery& GiFrame::rays() const { return *state_->rays; }
float GiFrame::exposure() const { return state_->exposure; }

} // namespace lambent
