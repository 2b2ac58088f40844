#include "gi/gi_frame.h"

#include "engine/core/error.h"
#include "engine/core/text.h"
#include "engine/trace/embree_query.h"
#include "gi/render/map_schedule.h"
#include "gi/render/passes.h"
#include "gi/vpl/sources.h"

#include <algorithm>
#include <bit>
#include <future>
#include <limits>
#include <utility>

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

/// A view with spans of its own: the scene's live only until its next extraction.
struct WorldCopy {
  SceneView view;
  std::vector<InstanceView> instances;
  std::vector<LightView> lights;
  std::vector<Aabb> addedOrRemoved;

  /// With `frozen` the instances stay what and where they were.
  void take(const SceneView& now, bool frozen) {
    lights.assign(now.lights.begin(), now.lights.end());
    const Aabb bounds = view.boundsWorld;
    view = now;
    if (frozen) {
      for (InstanceView& i : instances) {
        i.moved = i.reshaped = false;
        i.worldFromObjectBefore = i.worldFromObject;
        i.boundsWorldBefore = i.boundsWorld;
      }
      addedOrRemoved.clear();
      view.changes.geometry = view.changes.instances = false;
      view.boundsWorld = bounds;
    } else {
      instances.assign(now.instances.begin(), now.instances.end());
      addedOrRemoved.assign(now.addedOrRemoved.begin(), now.addedOrRemoved.end());
    }
    view.instances = instances;
    view.lights = lights;
    view.addedOrRemoved = addedOrRemoved;
  }
};

/// What an update of the VPLs depends on besides the world.
struct UpdateTask {
  SmcSettings smc;
  VplSettings vpl;
  VplEffects effects;
  bool settingsChanged;
  bool pretended; // done on a copy that is thrown away, because nothing calls for it
};

constexpr SceneChanges kAllChanged{true, true, true, true, true};

bool anyChange(const SceneChanges& c) { return c.first || c.camera || c.lights || c.geometry || c.instances; }

} // namespace

struct GiFrame::State {
  Settings settings, settingsBefore;
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
  WorldCopy world;
  LightSet lights;
  EffectPlan plan;
  bool settingsChanged = true, shadersChanged = false;
  bool missed = false; // something changed that VPLs or shadow maps were not told of
  bool frozen = false; // objects stand where they stood

  VplSet vpls;
  VplChanges changes;
  VplUpdateLog log;
  bool lightArrived = false; // an update ended that no picture shows yet

  std::vector<VplLight> vplLights;
  std::vector<Vpl> vplsShown; // only for a gather by rays
  std::vector<MapPose> poses, emitterPoses;
  std::vector<MapJob> mapJobs;
  MapSchedule mapSchedule;
  bool vplMapsOld = false; // VPLs were shown without maps
  float farDistance = 0;
  Aabb receivers;           // see visibleBounds
  uint64_t testedDraws = 0; // GpuScene's count at the end of the last frame
  bool calibrated = false;
  float exposure = 0;

  FrameResults results;
  FrameStats stats;
  std::future<void> updating; // last: its task uses the others

  State(const Settings& s, uint32_t seed_) : settings(s), seed(seed_) {}

  void begin(const SceneView& given);
  void planFrame(const SceneView& given);
  void placeWorld();
  void updateLight(const std::function<void(int, int)>& progress);
  UpdateTask updateTask(bool pretended) const;
  void update(const UpdateTask& task, const std::function<void(int, int)>& progress);
  void finishUpdate();
  void showUpdate();
  float mapReach();
  void prepareVplMaps(bool beside, const std::vector<uint32_t>& carried);
  void draw();
  std::vector<MapJob> emitterMapJobs(std::span<const MapPose> emitters, int resolution);
  DirectLight drawDirect(const GBuffer& gbuffer);
  IndirectLight drawIndirect(const GBuffer& gbuffer);
  void countWork();

  uint64_t& work(EffectId id) { return stats.work[size_t(id)]; }
};

GiFrame::GiFrame(const Settings& settings, uint32_t seed) : state_(std::make_unique<State>(settings, seed)) {}
GiFrame::~GiFrame() = default;

// The frame -----------------------------------------------------------------------------------------------------------

const FrameStats& GiFrame::run(const SceneView& view, const std::function<void(int, int)>& progress) {
  State& s = *state_;
  const auto begin = Clock::now();
  s.finishUpdate();
  s.begin(view);
  s.planFrame(view);
  s.placeWorld();
  if (s.plan.on(EffectId::Indirect)) s.updateLight(progress);
  if (s.plan.on(EffectId::Redraw)) s.draw();
  s.countWork();
  s.stats.wallMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return s.stats;
}

void GiFrame::State::begin(const SceneView& given) {
  CHECK(given.assets != nullptr);
  const uint32_t frame = stats.frame + (assets ? 1 : 0);
  stats = {};
  stats.frame = frame;
  if (!calibrated) {
    if (settings.debug.timing == TimingMode::Auto)
      profiler.calibrate();
    else
      profiler.choose(settings.debug.timing == TimingMode::Queries ? gl::Timing::Queries : gl::Timing::Finish);
    calibrated = true;
  }
  stats.timing = profiler.timing() == gl::Timing::Finish ? "finish" : "queries";
  if (assets != given.assets) {
    CpuScope scope(stats.stages, "scene");
    assets = given.assets;
    gpuScene = std::make_unique<GpuScene>(programs, *assets);
    rays = std::make_unique<EmbreeQuery>(*assets);
    vpls = {};
    changes = {};
    results = {};
    world = {};
    frozen = false;
    missed = true;
  }
}

void GiFrame::State::planFrame(const SceneView& given) {
  missed |= settingsBefore.effects != settings.effects;
  settingsChanged = settingsBefore != settings || shadersChanged || !results.picture.radiance;
  settingsBefore = settings;
  shadersChanged = false;
  const bool freeze = settings.effects[EffectId::Motion] == EffectMode::Off && !world.instances.empty();
  world.take(given, freeze);
  if (frozen && !freeze) missed = true;
  frozen = freeze;

  const FrameFacts facts{.first = !results.picture.radiance,
                         .settingsChanged = settingsChanged,
                         .settled = vpls.settling.settled(),
                         .mapsWaiting = uint32_t(mapSchedule.waiting()),
                         .lightArrived = lightArrived};
  SceneView& view = world.view;
  plan = planEffects(view, settings, facts);
  const auto everything = [&] { return plan.on(EffectId::Indirect) && plan.on(EffectId::Redraw); };
  if (missed && everything()) {
    view.changes = kAllChanged;
    plan = planEffects(view, settings, facts);
  }
  missed = !everything() && (missed || anyChange(view.changes));
  stats.plan = plan;
}

void GiFrame::State::placeWorld() {
  CpuScope scope(stats.stages, "scene");
  const SceneView& view = world.view;
  using enum EffectId;
  const AlphaTest alpha = !plan.on(Alpha) ? AlphaTest::None : plan.idle(Alpha) ? AlphaTest::All : AlphaTest::Masked;
  rays->setAlphaTest(alpha);
  gpuScene->setAlphaTest(alpha);
  rays->setTextures(plan.on(Textures));
  work(Motion) = rays->update(view, plan.idle(Motion));
  gpuScene->place(view.instances);
  lights = collectLights(view);
  if (!plan.on(Emissive)) {
    lights.emitters.clear();
    lights.triangles.clear();
    lights.emission = false;
  }
  if (!plan.on(Sky)) lights.sky = vec3(0);
}

// VPLs ----------------------------------------------------------------------------------------------------------------

/// Updates the VPLs, or starts to, and gets ready what the GPU needs of those that this frame shows.
void GiFrame::State::updateLight(const std::function<void(int, int)>& progress) {
  using enum EffectId;
  const auto called = [&](EffectId id) { return plan.on(id) && plan.calledFor(id); };
  const bool smc = settings.vpl.source == VplSource::Smc;
  const bool needed = vpls.slots.empty() || called(Replace) || (smc && (called(Relight) || called(Motion)));
  const bool pretended = !needed && smc && (plan.on(Replace) || plan.on(Relight) || plan.on(Motion));
  const bool beside = settings.frame.overlap && needed && !vpls.slots.empty();
  std::vector<uint32_t> carried;
  if (beside && smc) // other sources place theirs anew
    carried = carryVpls(vpls, world.view, world.view.changes.first);
  else if (!beside && (needed || pretended))
    update(updateTask(pretended), progress);
  showUpdate();
  if (plan.on(Redraw)) prepareVplMaps(beside, carried);
  if (beside) updating = std::async(std::launch::async, [this, task = updateTask(false)] { update(task, {}); });
}

/// A copy of all that settings decide: they may change while the task runs.
UpdateTask GiFrame::State::updateTask(bool pretended) const {
  using enum EffectId;
  UpdateTask task{settings.smc, settings.vpl, {}, settingsChanged, pretended};
  if (!plan.on(Bounces)) task.smc.bounces = std::min(task.smc.bounces, 1);
  task.effects = {.replace = plan.on(Replace),
                  .relight = plan.on(Relight),
                  .relightAll = plan.idle(Relight),
                  .carryAll = plan.idle(Motion),
                  .lastRays = plan.idle(Emissive) || plan.idle(Sky)};
  return task;
}

void GiFrame::State::update(const UpdateTask& task, const std::function<void(int, int)>& progress) {
  VplUpdate in{world.view, *rays, lights, task.smc, seed, task.vpl, task.effects, task.settingsChanged};
  log = {};
  VplSet copy;
  if (task.pretended) copy = vpls;
  const auto begin = Clock::now();
  VplChanges now = placeVpls(task.vpl.source, task.pretended ? copy : vpls, in, log, progress);
  log.ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  if (task.pretended) return;
  const auto join = [](std::vector<uint32_t>& slots, const std::vector<uint32_t>& unshown) {
    std::vector<uint32_t> all;
    std::set_union(slots.begin(), slots.end(), unshown.begin(), unshown.end(), std::back_inserter(all));
    slots = std::move(all);
  };
  join(now.movedSlots, changes.movedSlots);
  join(now.placedSlots, changes.placedSlots);
  changes = std::move(now);
}

/// Waits for the update that runs beside the GPU, if one does.
void GiFrame::State::finishUpdate() {
  if (!updating.valid()) return;
  updating.get();
  lightArrived = true;
}

/// Takes the figures of the update that this frame's picture shows.
void GiFrame::State::showUpdate() {
  lightArrived = false;
  for (StageTime& row : log.stages) stats.stages.push_back(std::move(row));
  stats.updateMs = log.ms;
  stats.raysPoints += log.points;
  stats.raysValidation = log.validation;
  stats.raysCandidates = log.candidates;
  stats.raysRadiosity = log.radiosity;
  stats.raysCells = log.cells;
  stats.vplsRelit = log.relit;
  stats.vplsKept = changes.kept;
  stats.vplsMoved = uint32_t(changes.movedSlots.size());
  stats.vplsInvalid = changes.invalid;
  stats.vplsAlive = changes.alive;
  stats.vplsStrong = changes.strong;
  stats.burst = changes.burst;
  for (const auto* all : {&vpls.samplerPaths, &vpls.lightPaths, &vpls.poolPaths})
    for (const KeptPaths& k : *all) stats.pathsHeld += k.lengths.size();
  stats.pathsTraced = log.paths.traced;
  stats.pathsRetraced = log.paths.retraced;
  const auto total = [](const RayCounts& c) { return c.closest + c.occlusion; };
  using enum EffectId;
  work(Bounces) = log.paths.bounceRays;
  work(Relight) = log.relitForChange;
  work(Replace) = total(log.points) + total(log.validation) + total(log.candidates);
  work(Indirect) = work(Replace) + total(log.radiosity) + total(log.cells);
  if (plan.on(Emissive)) work(Emissive) += log.paths.lastRays;
  if (plan.on(Sky)) work(Sky) += log.paths.lastRays;
  log = {};
}

/// Distance that stands for 1 in the maps. All are drawn anew when it changes, so it leaves room to grow.
float GiFrame::State::mapReach() {
  const float wanted = world.view.boundsWorld.diameter();
  if (wanted > farDistance || wanted < 0.5f * farDistance)
    farDistance = world.view.changes.geometry && farDistance > 0 ? 1.25f * wanted : wanted;
  return farDistance;
}

/// Lists the maps of lights that stand elsewhere, and as far as the budget goes of those that see where objects moved.
void GiFrame::State::prepareVplMaps(bool beside, const std::vector<uint32_t>& carried) {
  using enum EffectId;
  const SceneView& view = world.view;
  vplLights.clear();
  mapJobs.clear();
  if (settings.smc.visibility == VplVisibility::Rays) {
    vplsShown = vpls.slots;
    vplMapsOld = true;
    return;
  }
  // Those that were carried by the update of the frame before stand where that frame had put them.
  const std::vector<uint32_t>& moved = beside ? changes.placedSlots : changes.movedSlots;
  std::vector<uint32_t> elsewhere;
  std::set_union(moved.begin(), moved.end(), carried.begin(), carried.end(), std::back_inserter(elsewhere));
  std::erase_if(elsewhere, [&](uint32_t slot) { return slot >= vpls.slots.size(); });
  changes.movedSlots.clear(); // they have their maps after this frame
  changes.placedSlots.clear();

  const int resolution = settings.shadow.resolution;
  std::vector<float> brightness;
  for (const Vpl& v : vpls.slots) {
    vplLights.push_back(vplLight(v));
    // A light that brings nothing now may do so later, so its map is not given up.
    brightness.push_back(v.alive ? std::max(v.intensity(), 1e-20f) : 0);
  }
  poses = mapPoses(vpls);
  const ParaboloidMapInputs in{*gpuScene, rays.get(), poses, {}, mapReach(), resolution, settings.shadow.maker};
  if (vplMapPass.drawsAllAnew(in)) {
    mapSchedule.clear();
    vplMapsOld = false;
    return;
  }
  int64_t budget = int64_t(settings.shadow.refresh) * resolution * resolution;
  if (view.changes.first || vplMapsOld) {
    vplMapsOld = false;
    mapSchedule.disturbAll(poses.size(), resolution);
    budget = std::numeric_limits<int64_t>::max();
  } else if (!plan.on(MapRefresh)) {
    budget = 0;
  } else if (plan.idle(MapRefresh)) {
    mapSchedule.disturbInTurn(poses.size(), size_t(settings.shadow.refresh), resolution);
  } else if (view.changes.geometry || view.changes.instances) {
    mapSchedule.disturb(poses, brightness, Disturbance(view), *rays, resolution, settings.shadow.motionRays, seed,
                        stats.frame, stats.raysMapTests);
  }
  mapJobs = mapSchedule.take(elsewhere, brightness, resolution, budget);
  stats.mapsWaiting = uint32_t(mapSchedule.waiting());
  work(MapRefresh) = mapJobs.size() - elsewhere.size() + stats.raysMapTests.occlusion;
  for (const MapJob& job : mapJobs) stats.mapTexelsDrawn += uint64_t(texelsTraced(job.texels, job.coarse));
}

// Drawing -------------------------------------------------------------------------------------------------------------

void GiFrame::State::draw() {
  const SceneView& view = world.view;
  const uint64_t draws = gl::drawCount();
  results = {};
  const GBuffer gbuffer = gbufferPass.run({*gpuScene, view.camera});
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
}

/// Lamps that stand elsewhere get a new map, others the part that an object moved through.
std::vector<MapJob> GiFrame::State::emitterMapJobs(std::span<const MapPose> emitters, int resolution) {
  const Disturbance moved(world.view);
  std::vector<MapJob> jobs;
  for (uint32_t i = 0; i < emitters.size(); ++i) {
    TexelRect texels;
    if (world.view.changes.first || i >= emitterPoses.size() || emitters[i] != emitterPoses[i])
      texels = TexelRect::whole(resolution);
    else
      for (const Aabb& box : moved.boxes()) texels.add(texelsCovered(emitters[i], box, resolution));
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
  const Disturbance moved(view);
  const LightShadows& shadows = lightShadowPass.run({*gpuScene, view.lights, plan.on(Sky), lights.sky, receivers,
                                                     view.boundsWorld, view.changes.first, moved.boxes(), shadow});
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

IndirectLight GiFrame::State::drawIndirect(const GBuffer& gbuffer) {
  const uint64_t draws = gl::drawCount();
  if (settings.smc.visibility == VplVisibility::Rays) {
    CpuScope scope(stats.stages, "gather by rays");
    return indirectUpload.run(imageOf(
        world.view.camera, gatherByRays(*rays, world.view.camera, vplsShown, settings.gather, stats.raysGather)));
  }
  const VplLights shown = vplBuffer.run(vplLights);
  const ParaboloidMaps maps = vplMapPass.run(
      {*gpuScene, rays.get(), poses, mapJobs, mapReach(), settings.shadow.resolution, settings.shadow.maker});
  stats.mapsDrawn += vplMapPass.mapsDrawn();
  stats.shadowMaker = vplMapPass.makerReport();
  const RawIndirect raw = gatherPass.run({gbuffer, shown, &maps, settings.shadow.bias, settings.gather});
  results.raw = raw;
  results.vplMaps = maps;
  FilterSettings filter = settings.filter;
  filter.on = filter.on && plan.on(EffectId::Filter);
  const uint64_t filterDraws = gl::drawCount();
  const IndirectLight indirect = filterPass.run({gbuffer, raw, filter});
  if (filter.on) work(EffectId::Filter) = gl::drawCount() - filterDraws;
  work(EffectId::Indirect) += gl::drawCount() - draws + vplMapPass.mapsDrawn();
  return indirect;
}

void GiFrame::State::countWork() {
  const EmbreeQuery::Work done = rays->takeWork();
  work(EffectId::Textures) = done.textureLookups;
  const uint64_t draws = gpuScene->testedDraws();
  work(EffectId::Alpha) = done.alphaTests + draws - std::exchange(testedDraws, draws);
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
  if (buffer == Buffer::Vpls) state_->finishUpdate();
  state_->displayPass.run(buffer, state_->results, state_->exposure, state_->settings.debug.nan);
  return state_->displayPass.read();
}

void GiFrame::present(Buffer buffer, uint32_t framebuffer, int width, int height) const {
  if (buffer == Buffer::Vpls) state_->finishUpdate();
  state_->displayPass.run(buffer, state_->results, state_->exposure, state_->settings.debug.nan);
  state_->displayPass.present(framebuffer, width, height);
}

ShadowAgreement GiFrame::compareShadowMaps(const SceneView& view, int slots, int points,
                                           const std::function<void(int, int)>& progress) {
  State& s = *state_;
  s.finishUpdate();
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

std::vector<std::string> GiFrame::reloadShaders() {
  std::vector<std::string> messages = state_->programs.reloadChanged();
  state_->shadersChanged |= !messages.empty();
  return messages;
}

Settings& GiFrame::settings() { return state_->settings; }
const VplSet& GiFrame::vpls() const {
  state_->finishUpdate();
  return state_->vpls;
}
const RayQuery& GiFrame::rays() const { return *state_->rays; }
float GiFrame::exposure() const { return state_->exposure; }

} // namespace lambent
