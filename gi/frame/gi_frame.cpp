#include "gi/frame/gi_frame.h"

#include "engine/core/error.h"
#include "engine/core/text.h"
#include "engine/gl/context.h"
#include "engine/gl/state_guard.h"
#include "gi/direct/direct_light.h"
#include "gi/viewer/picture.h"
#include "gi/frame/world_state.h"
#include "gi/gather/stages.h"
#include "gi/cube/draw/still_cache.h"
#include "gi/sources/light_source.h"
#include "gi/surfaces/surfaces.h"
#include "gi/visibility/shadow_map_cache.h"

#include <chrono>

namespace lambent {

namespace {

using Clock = std::chrono::steady_clock;

/// GL draws since it was made.
class DrawCount {
 public:
  uint64_t operator()() const { return gl::counts().draws - before_; }

 private:
  uint64_t before_ = gl::counts().draws;
};

/// Before and after what mixes it over pixels and pictures.
struct Indirect {
  SurfaceLighting gathered, light;
};

} // namespace

/// The stages, in data-flow order. What one of them keeps from frame to frame is its own.
struct GiFrame::Kept {
  Settings settings;
  uint32_t seed;

  gl::ProgramCache programs;
  gl::GpuProfiler profiler;
  PassContext context{programs, profiler};
  WorldState world{programs};
  SurfacePass surfaces{context};
  PatchPass patches{context, StageId::Patches};
  DirectLight direct{context};
  ShadowMapCache keeper{context};
  IndirectStages indirectStages{context};
  StillCache stillCache{context};
  HistoryPass history{context};
  FilterPass filter{context};
  CompositePass composite{context};
  DisplayPass display{context};
  TruthDisplay truth{context};
  std::unique_ptr<LightSource> source; // below the world, which its update reads
  VplSource sourceOf = VplSource::None;

  int averaged = 0; // pictures in the history since anything changed
  float exposure = 0;
  FrameResults results;
  FrameStats stats;

  Kept(const Settings& s, uint32_t seed_) : settings(s), seed(seed_) {}

  void begin(const SceneView& given);
  void end(Clock::time_point begin, const gl::Counts& before);
  LightSource* sourceFor(VplSource wanted);
  Indirect lightIndirectly(const World& given, const EffectPlan& plan, const VirtualLights& lights,
                           const GBuffer& surfaces, Patches& patches, const std::function<void(int, int)>& progress);
  /// Light is averaged over pictures. (Forced, it has nothing to do.)
  bool averages(const EffectPlan& plan) const {
    return plan.on(EffectId::History) && plan.calledFor(EffectId::History);
  }
  FilterSettings filterFor(const EffectPlan& plan) const;
  void expose(const Picture& picture);
  Look look() const { return {exposure, settings.image.toneMapper, settings.debug.nan, settings.image.antiAliasing}; }
};

GiFrame::GiFrame(const Settings& settings, uint32_t seed) : kept_((gl::requireContext(), std::make_unique<Kept>(settings, seed))) {}
GiFrame::~GiFrame() = default;

void GiFrame::restart() {
  const Settings settings = kept_->settings;
  const uint32_t seed = kept_->seed;
  kept_.reset(); // not both in memory
  kept_ = std::make_unique<Kept>(settings, seed);
}

// The frame -----------------------------------------------------------------------------------------------------------

const FrameStats& GiFrame::run(const SceneView& given, const std::function<void(int, int)>& told,
                               const HostSurfaces* host) {
  const gl::StateGuard guard;
  const std::function<void(int, int)> progress = gl::callingOut(told);
  Kept& k = *kept_;
  const Settings& settings = k.settings;
  if (const std::string reason = whyNot(settings); !reason.empty()) throw InputError("settings", reason);
  if (host) checkHost(*host, given.camera);
  const Clock::time_point begin = Clock::now();
  const gl::Counts before = gl::counts();
  LightSource* source = k.sourceFor(settings.vpl.source);
  if (source) source->wait();
  k.begin(given);
  FrameStats& stats = k.stats;
  k.stillCache.watch(given, settings);
  const EffectPlan plan = k.world.plan(given, settings,
                                       {.first = !k.results.picture.radiance,
                                        .host = host != nullptr,
                                        .settled = source && source->settled(),
                                        .mapsWaiting = k.keeper.waiting(),
                                        .averaged = k.averaged,
                                        .lightArrived = source && source->arrived(),
                                        .storedAlone = k.stillCache.alone(),
                                        .storing = k.stillCache.busy()});
  const World world = k.world.place(plan, stats);
  stats.plan = plan;
  if (!k.averages(plan) || k.world.gatherChanged()) k.history.forget();

  VirtualLights lights;
  const bool gathers = plan.on(EffectId::Gather) || rowOf(settings.vpl.source).sampled;
  if (source && plan.on(EffectId::Indirect) && gathers)
    lights = source->run({world, plan, settings, k.seed, k.world.settingsChanged(), progress}, stats);
  stats.vplsAlive = lights.alive;

  if (plan.on(EffectId::Redraw)) {
    const DrawCount draws;
    k.results = {};
    const bool glossy = settings.gather.glossy && plan.on(EffectId::Glossy);
    const bool keep = !plan.seenChanges();
    const GBuffer surfaces = k.surfaces.run({world.gpu, world.view.camera, glossy, host, keep});
    Patches patches([&] { return k.patches.run(surfaces, settings.multires); });
    const SurfaceLighting direct = k.direct.run({world, surfaces, plan, settings, patches, keep}, stats);
    const Indirect indirect = k.lightIndirectly(world, plan, lights, surfaces, patches, progress);
    const Picture picture = k.composite.run({surfaces, direct, indirect.light, world.view.sky});
    stats.of(EffectId::Redraw) = draws();
    if (glossy) stats.of(EffectId::Glossy) = draws();
    k.expose(picture);
    k.results = {surfaces,       direct,          indirect.gathered, indirect.light,
                 picture,        k.keeper.maps(), patches.made(),    source ? source->set() : nullptr,
                 world.view.sky, world.reach};
  }

  k.end(begin, before);
  return stats;
}

/// New figures; the first time, how GPU times are taken; all anew for another scene.
void GiFrame::Kept::begin(const SceneView& given) {
  CHECK(given.assets != nullptr);
  const bool first = stats.timing.empty();
  const uint32_t frame = first ? 0 : stats.frame + 1;
  stats = {};
  stats.frame = frame;
  if (first) {
    if (settings.debug.timing == TimingMode::Auto)
      profiler.calibrate();
    else
      profiler.choose(settings.debug.timing == TimingMode::Queries ? gl::Timing::Queries : gl::Timing::Finish);
  }
  stats.timing = profiler.timing() == gl::Timing::Finish ? "finish" : "queries";
  if (!world.open(*given.assets, stats)) return;
  if (source) source->forget();
  keeper.forget();
  stillCache.forget();
  history.forget();
  results = {};
}

/// Light that virtual lights bring to the surfaces: seen, gathered, averaged and mixed.
Indirect GiFrame::Kept::lightIndirectly(const World& given, const EffectPlan& plan, const VirtualLights& lights,
                                        const GBuffer& surfaces, Patches& patches,
                                        const std::function<void(int, int)>& progress) {
  Indirect out;
  if (!plan.on(EffectId::Indirect)) {
    stillCache.forget();
    return out;
  }
  const DrawCount draws;
  const bool more = plan.on(EffectId::Bounces) && rowOf(settings.vpl.source).sampled;
  const int bounces = more ? settings.smc.bounces : 1;
  if (plan.on(EffectId::Gather) || rowOf(settings.gather.mode).stored) {
    const DrawCount gatherDraws;
    const ShadowedLights seen = keeper.see({given, lights, settings, seed}, plan, stats);
    const bool averaging = averages(plan), changes = averaging && plan.lightChanges();
    if (averaging) history.fit(surfaces);
    out.gathered = indirectStages.of(settings).run(
        {given, surfaces, patches, seen, settings, bounces, seed, averaging ? history.picture() : 0, averaging, changes,
         averaging && !changes && !given.view.changes.camera && !history.follows(), plan.on(EffectId::Gather), ~0u,
         progress},
        stats);
    if (plan.on(EffectId::Gather)) stats.of(EffectId::Gather) = gatherDraws();
    const FilterSettings filtering = filterFor(plan);
    SurfaceLighting mean = out.gathered;
    if (averaging) {
      const DrawCount historyDraws;
      mean = history.run(
          {surfaces, out.gathered, given.view.changes.camera, plan.lightChanges(), settings.history, filtering});
      stats.of(EffectId::History) = historyDraws();
      averaged = plan.changed() ? 1 : averaged + 1;
    }
    const DrawCount filterDraws;
    out.light = filter.run({surfaces, mean, filtering, !averaging});
    if (filtering.on) stats.of(EffectId::Filter) = filterDraws();
  } else {
    history.forget(); // it would be of another place
  }
  out.light = stillCache.run({given, surfaces, patches, plan, settings, seed, bounces}, out.light, stats);
  stats.of(EffectId::Indirect) += draws();
  return out;
}

/// What was asked of the GPU, and how long the frame took.
void GiFrame::Kept::end(Clock::time_point begin, const gl::Counts& before) {
  for (const StageTime& row : profiler.takeRows()) stats.stages.push_back(row);
  world.countWork(stats);
  const gl::Counts asked = gl::counts() - before;
  stats.draws = asked.draws;
  stats.waits = asked.waits;
  stats.readBacks = asked.readBacks;
  stats.wallMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Sources of another kind are given up with all that they keep.
LightSource* GiFrame::Kept::sourceFor(VplSource wanted) {
  if (!sameKind(wanted, sourceOf)) {
    results.vpls = nullptr;
    source = makeSource(wanted, context);
  }
  sourceOf = wanted;
  return source.get();
}

FilterSettings GiFrame::Kept::filterFor(const EffectPlan& plan) const {
  FilterSettings filter = settings.filter;
  filter.on = filter.on && plan.on(EffectId::Filter);
  return filter;
}

void GiFrame::Kept::expose(const Picture& picture) {
  if (settings.image.exposure > 0)
    exposure = settings.image.exposure;
  else if (exposure <= 0)
    exposure = measureExposure(picture);
}

// Looking at it -------------------------------------------------------------------------------------------------------

namespace {
const std::vector<std::string> kBufferNames = {"beauty",      "direct",  "indirect", "irradiance", "albedo",
                                               "normal",      "depth",   "emission", "unfiltered", "vpls",
                                               "shadow-maps", "patches", "nan"};
}

const std::vector<std::string>& bufferNames() { return kBufferNames; }

Buffer bufferByName(const std::string& name) {
  for (size_t i = 0; i < kBufferNames.size(); ++i)
    if (kBufferNames[i] == name) return Buffer(i);
  const std::string near = nearestName(name, kBufferNames);
  std::string all;
  for (const std::string& n : kBufferNames) all += (all.empty() ? "" : ", ") + n;
  throw InputError("--buffer " + name, "no such buffer (" + (near.empty() ? all : "did you mean " + near + "?") + ")");
}

Image GiFrame::read(Buffer buffer) const {
  const gl::StateGuard guard;
  return readBuffer(buffer, kept_->results);
}

Image8 GiFrame::readDisplay(Buffer buffer) const {
  const gl::StateGuard guard;
  if (buffer == Buffer::Vpls && kept_->source) kept_->source->wait(); // an update takes the set away
  kept_->display.run(buffer, kept_->results, kept_->look());
  return kept_->display.read();
}

void GiFrame::present(Buffer buffer, uint32_t framebuffer, int width, int height) const {
  const gl::StateGuard guard;
  if (buffer == Buffer::Vpls && kept_->source) kept_->source->wait(); // an update takes the set away
  kept_->display.run(buffer, kept_->results, kept_->look());
  kept_->display.present(framebuffer, width, height);
}

void GiFrame::takeTruth(const Image& truth) {
  const gl::StateGuard guard;
  kept_->truth.take(truth, kept_->results);
}

void GiFrame::presentBesideTruth(Buffer buffer, float divider, uint32_t framebuffer, int width, int height) const {
  const gl::StateGuard guard;
  const gl::Texture& truth = kept_->truth.run(buffer, kept_->results, kept_->look());
  kept_->display.run(buffer, kept_->results, kept_->look());
  kept_->display.present(framebuffer, width, height, &truth, divider);
}

void GiFrame::presentError(Buffer buffer, float full, uint32_t framebuffer, int width, int height) const {
  const gl::StateGuard guard;
  kept_->display.run(buffer, kept_->results, kept_->look(), {&kept_->truth.linear(), full});
  kept_->display.present(framebuffer, width, height);
}

uint32_t GiFrame::texture(Buffer buffer) const {
  const FrameResults& r = kept_->results;
  const gl::Texture* texture = buffer == Buffer::Beauty       ? r.picture.radiance
                               : buffer == Buffer::Direct     ? r.direct.irradiance
                               : buffer == Buffer::Irradiance ? r.indirect.irradiance
                                                              : nullptr;
  return texture ? texture->name() : 0;
}

ShadowAgreement GiFrame::compareShadowMaps(const SceneView& view, int slots, int points,
                                           const std::function<void(int, int)>& progress) {
  const gl::StateGuard guard;
  Kept& k = *kept_;
  const std::vector<VirtualLight> lights = lightsOf(vpls());
  const ShadowSettings& shadow = k.settings.shadow;
  const World world = k.world.again();
  std::vector<MapPose> poses;
  for (const VirtualLight& light : lights) poses.push_back(light.pose(world.rays.rayEpsilon()));
  const ParaboloidMapInputs maps{world.gpu,         &world.rays, poses, {}, view.boundsWorld.diameter(),
                                 shadow.resolution, shadow.maker};
  return measureShadowAgreement(k.keeper.pass(), maps, world.rays, view.camera, lights, k.settings, slots, points,
                                gl::callingOut(progress));
}

std::vector<std::string> GiFrame::reloadShaders() {
  std::vector<std::string> messages = kept_->programs.reloadChanged();
  if (!messages.empty()) kept_->world.shadersChanged();
  return messages;
}

Settings& GiFrame::settings() { return kept_->settings; }
const FrameStats& GiFrame::stats() const { return kept_->stats; }
const VplSet& GiFrame::vpls() const {
  static const VplSet none;
  if (kept_->source) kept_->source->wait();
  const VplSet* set = kept_->source ? kept_->source->set() : nullptr;
  return set ? *set : none;
}
const RayQuery& GiFrame::rays() const { return kept_->world.again().rays; }
float GiFrame::exposure() const { return kept_->exposure; }

} // namespace lambent
