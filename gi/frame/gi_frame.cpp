#include "gi/frame/gi_frame.h"

#include "engine/core/error.h"
#include "engine/core/free_memory.h"
#include "engine/core/memory.h"
#include "engine/gl/context.h"
#include "engine/gl/counts.h"
#include "engine/gl/state_guard.h"
#include "gi/contract/frame_outputs.h"
#include "gi/direct/direct_light.h"
#include "gi/frame/mirror_pass.h"
#include "gi/frame/world_state.h"
#include "gi/near/light_at_points.h"
#include "gi/surfaces/surfaces.h"
#include "gi/visibility/paraboloid_maps.h"
#include "gi/vpl/asked_memory.h"

#include <chrono>

namespace lambent {

namespace {
using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;
} // namespace

/// What one stage keeps from frame to frame is its own.
struct GiFrame::Kept {
  Settings settings;
  uint32_t seed;

  gl::ProgramCache programs;
  gl::GpuProfiler profiler;
  PassContext context;
  WorldState world{context};
  SurfacePass surfaces{context};
  PatchPass patches{context, StageId::Patches};
  DirectLight direct{context};
  MirrorPass mirrors{context};
  std::unique_ptr<LightProvider> indirect; // below the world, which its update reads
  const Technique* indirectOf = nullptr;
  double bytesOfLights = 0; // that were asked for last

  FrameOutputs outputs;
  FrameStats stats;

  Kept(const Settings& s, uint32_t seed_, Makers makers, const fs::path& shaders)
      : settings(s), seed(seed_), programs(shaders), context{programs, profiler, makers} {}

  LightProvider& technique();
  void refuseBeyondMemory(const Settings& asked);
  void begin(const SceneView& given);
  void end(Clock::time_point begin, const gl::Counts& before);
};

GiFrame::GiFrame(const Settings& settings, uint32_t seed, Makers makers, const std::optional<fs::path>& shaders)
    : kept_((gl::requireContext(),
             std::make_unique<Kept>(settings, seed, makers, shaders.value_or(gl::shaderFolder())))) {}
GiFrame::~GiFrame() = default;

void GiFrame::restart() {
  const Settings settings = kept_->settings;
  const uint32_t seed = kept_->seed;
  const Makers makers = kept_->context.makers;
  const fs::path shaders = kept_->programs.folder();
  kept_.reset(); // not both in memory
  kept_ = std::make_unique<Kept>(settings, seed, makers, shaders);
}

// The frame -----------------------------------------------------------------------------------------------------------

const FrameStats& GiFrame::run(const SceneView& given, const std::function<void(int, int)>& told,
                               const HostSurfaces* host) {
  const gl::StateGuard guard;
  const std::function<void(int, int)> progress = gl::callingOut(told);
  Kept& k = *kept_;
  Settings settings = asGathered(k.settings);
  FrameStats& stats = k.stats;
  if (const std::string reason = whyNot(settings); !reason.empty()) throw InputError("settings", reason);
  k.refuseBeyondMemory(settings);
  if (host) checkHost(*host, given.camera);
  SceneView seen = given;
  seen.camera.throughBlended = host != nullptr;
  const Clock::time_point begin = Clock::now();
  const gl::Counts before = gl::counts();

  LightProvider& indirect = k.technique();
  indirect.wait();
  k.begin(seen);
  k.world.take(seen, settings);
  indirect.begin(k.world.view(), settings);
  k.outputs.inside = indirect.inside(); // parts of another technique are gone
  const Needs needs = needsOf(settings);
  const EffectPlan plan = k.world.plan(settings, {.first = !k.outputs.surfaces.depth,
                                                  .host = host != nullptr,
                                                  .needs = needs,
                                                  .status = indirect.status(),
                                                  .directPending = settings.direct.on && k.direct.pending(),
                                                  .mirrorsPending = k.mirrors.pending()});
  if (!plan.on(EffectId::Mirrors)) settings.gather.mirrors = 0; // virtual lights bring all of every lobe
  const World world = k.world.place(plan, stats);
  stats.plan = plan;
  const FrameWorld now{.world = world,
                       .plan = plan,
                       .settings = settings,
                       .seed = k.seed,
                       .settingsChanged = k.world.settingsChanged(),
                       .gatherChanged = k.world.gatherChanged(),
                       .restart = k.world.gatherChanged() || k.world.settingsChanged() || world.view.changes.any(),
                       .progress = progress};
  indirect.update(now, stats);

  if (plan.on(EffectId::Redraw)) {
    const gl::DrawCount draws;
    const FrameOutputs last = std::exchange(k.outputs, {}); // what something is thrown out of counts as no frame
    FrameOutputs out;
    out.sky = world.view.sky;
    out.farDistance = world.farDistance;
    const bool glossy = settings.gather.glossy && plan.on(EffectId::Glossy);
    const bool normalMaps = plan.on(EffectId::NormalMaps);
    out.surfaces = k.surfaces.run({.scene = world.gpu,
                                   .camera = world.view.camera,
                                   .glossy = glossy,
                                   .normalMaps = normalMaps,
                                   .host = host,
                                   .keep = !plan.seenChanges(),
                                   .previous = needs.previousSurfaces});
    Patches patches([&] { return k.patches.run(out.surfaces, settings.multires); });
    const int bounces = plan.on(EffectId::Bounces) && needs.bounces ? settings.smc.bounces : 1;
    const Frame frame{now, out.surfaces, patches, k.surfaces.previous(), bounces};
    if (settings.direct.on)
      out.direct = k.direct.run(frame, stats);
    else
      k.direct.forget();
    bool mirrored = plan.onlyDirect(); // in the light that stays
    if (plan.onlyDirect()) {
      out.indirect = last.indirect;
    } else if (plan.on(EffectId::Indirect)) {
      const gl::DrawCount ofIndirect;
      out.indirect = indirect.run(frame, stats);
      mirrored = settings.gather.mirrors > 0 && out.indirect.glossy;
      if (mirrored) out.indirect = k.mirrors.add(frame, out.indirect, stats);
      stats.of(EffectId::Indirect) += ofIndirect();
    }
    if (!mirrored) k.mirrors.forget();
    out.patches = plan.onlyDirect() ? last.patches : patches.made();
    k.outputs = out;
    stats.of(EffectId::Redraw) = draws();
    if (glossy) stats.of(EffectId::Glossy) = draws();
    if (out.surfaces.mappedNormal) stats.of(EffectId::NormalMaps) = draws();
  }
  k.outputs.inside = indirect.inside();
  k.end(begin, before);
  return stats;
}

/// The provider of the technique that the settings choose. One of another technique is given up with all that it keeps.
LightProvider& GiFrame::Kept::technique() {
  if (!indirect || indirectOf != settings.own) {
    if (indirect) indirect->wait();
    outputs.indirect = {};
    outputs.inside = {};
    indirect = nullptr; // not both in memory
    indirect = makeTechnique(settings, context);
    indirectOf = settings.own;
  }
  return *indirect;
}

/// Before more lights, or maps of them, are asked for than memory holds.
void GiFrame::Kept::refuseBeyondMemory(const Settings& asked) {
  constexpr double kTexel = 2; // bytes
  const Needs needs = needsOf(asked);
  const double side = asked.shadow.resolution;
  const double lights = needs.sampled() ? bytesOfVpls(asked.smc, asked.vpl) : 0;
  const double maps = needs.sampled() && needs.maps && context.drawnByCpu ? kTexel * asked.smc.vpls * side * side : 0;
  if (lights + maps > bytesOfLights) {
    const size_t free = freeMemory();
    lambent::refuseBeyondMemory(asked.smc, asked.vpl, free);
    if (const double more = lights + maps - bytesOfLights; more > double(free)) // what is held makes room
      throw InputError("settings",
                       "smc.vpls and shadow.resolution ask for " + moreThanIsLeft(more, "lower one of them"));
  }
  bytesOfLights = lights + maps;
}

/// New figures; the first time, how GPU times are taken; everything from scratch for another scene.
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
  if (!world.open(*given.assets, settings, stats)) return;
  indirect->forget();
  direct.forget();
  mirrors.forget();
  surfaces.forget();
  outputs = {};
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

// What it gives -------------------------------------------------------------------------------------------------------

namespace {
uint32_t nameOf(const gl::Texture* texture) { return texture ? texture->name() : 0; }
} // namespace

uint32_t GiFrame::directIrradiance() const { return nameOf(kept_->outputs.direct.irradiance); }
uint32_t GiFrame::indirectIrradiance() const { return nameOf(kept_->outputs.indirect.irradiance); }
bool GiFrame::converged() const {
  const Kept& k = *kept_;
  if (!k.outputs.surfaces.depth || k.world.view().changes.any()) return false;
  const bool gathers = k.indirect && k.stats.plan.on(EffectId::Indirect);
  const ProviderStatus status = gathers ? k.indirect->status() : ProviderStatus{};
  return status.pending.empty() && status.mapsWaiting == 0 && !(k.settings.direct.on && k.direct.pending()) &&
         !k.mirrors.pending();
}
const FrameOutputs& GiFrame::outputs() const { return kept_->outputs; }
PassContext GiFrame::context() const { return kept_->context; }

std::vector<vec3> GiFrame::indirectAt(std::span<const SurfaceHit> points) const {
  const std::vector<VirtualLight> lights = lightsOf(vpls());
  const World world = kept_->world.current();
  if (lights.empty() && !kept_->stats.plan.on(EffectId::Indirect)) return std::vector<vec3>(points.size(), vec3(0));
  if (lights.empty())
    throw InputError("light at points", "the technique keeps no virtual lights on the CPU (smc, ir, mir and tcas do)");
  return indirectAtPoints({world.view, world.rays, world.lights, lights, asGathered(kept_->settings), kept_->seed},
                          points);
}

std::vector<vec3> GiFrame::directAt(std::span<const SurfaceHit> points) const {
  kept_->indirect->wait();
  const World world = kept_->world.current();
  return directAtPoints({world.view, world.rays, world.lights, {}, kept_->settings, kept_->seed}, points);
}

ShadowAgreement GiFrame::compareShadowMaps(const SceneView& view, int slots, int points,
                                           const std::function<void(int, int)>& progress) {
  const gl::StateGuard guard;
  Kept& k = *kept_;
  const std::vector<VirtualLight> lights = lightsOf(vpls());
  const World world = k.world.current();
  std::vector<MapPose> poses;
  for (const VirtualLight& light : lights) poses.push_back(light.pose(world.rays.rayEpsilon()));
  const ParaboloidMapInputs maps{.scene = world.gpu,
                                 .rays = &world.rays,
                                 .poses = poses,
                                 .farDistance = view.boundsWorld.diameter(),
                                 .resolution = k.settings.shadow.resolution,
                                 .maker = k.settings.shadow.maker};
  ParaboloidMapPass pass(k.context, StageId::VplMaps);
  return measureShadowAgreement(pass, maps, world.rays, view.camera, lights, k.settings, slots, points,
                                gl::callingOut(progress));
}

std::vector<std::string> GiFrame::reloadShaders() {
  std::vector<std::string> messages = kept_->programs.reloadChanged();
  if (!messages.empty()) kept_->world.shadersChanged();
  return messages;
}

Settings& GiFrame::settings() { return kept_->settings; }
const Settings& GiFrame::settings() const { return kept_->settings; }
const FrameStats& GiFrame::stats() const { return kept_->stats; }
const VplSet& GiFrame::vpls() const {
  static const VplSet none;
  if (!kept_->indirect) return none;
  kept_->indirect->wait();
  const VplSet* set = kept_->indirect->inside().vpls;
  return set ? *set : none;
}
const RayQuery& GiFrame::rays() const { return kept_->world.current().rays; }

} // namespace lambent
