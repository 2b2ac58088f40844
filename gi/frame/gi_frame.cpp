#include "gi/frame/gi_frame_state.h"

#include "engine/core/error.h"
#include "engine/core/text.h"
#include "engine/gl/state_guard.h"

#include <utility>

namespace lambent {

namespace {

constexpr SceneChanges kAllChanged{true, true, true, true, true};

bool anyChange(const SceneChanges& c) { return c.first || c.camera || c.lights || c.geometry || c.instances; }

} // namespace

GiFrame::GiFrame(const Settings& settings, uint32_t seed) : state_(std::make_unique<State>(settings, seed)) {}
GiFrame::~GiFrame() = default;

// The frame -----------------------------------------------------------------------------------------------------------

const FrameStats& GiFrame::run(const SceneView& view, const std::function<void(int, int)>& progress) {
  State& s = *state_;
  const gl::StateGuard guard;
  const auto begin = std::chrono::steady_clock::now();
  const gl::Counts before = gl::counts();
  s.finishUpdate();
  s.begin(view);
  s.planFrame(view);
  s.placeWorld();
  if (s.plan.on(EffectId::Indirect)) s.updateLight(progress);
  if (s.plan.on(EffectId::Redraw)) s.draw();
  s.countWork();
  const gl::Counts asked = gl::counts() - before;
  s.stats.draws = asked.draws;
  s.stats.waits = asked.waits;
  s.stats.readBacks = asked.readBacks;
  s.stats.wallMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
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
    CpuScope scope(stats.stages, key(StageId::Scene));
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
  const bool drawingChanged = settingsBefore != settings || shadersChanged;
  settingsChanged = settingsBefore.smc != settings.smc || settingsBefore.vpl != settings.vpl ||
                    settingsBefore.effects != settings.effects || !results.picture.radiance;
  settingsBefore = settings;
  shadersChanged = false;
  const bool freeze = settings.effects[EffectId::Motion] == EffectMode::Off && !world.instances.empty();
  world.take(given, freeze);
  if (frozen && !freeze) missed = true;
  frozen = freeze;

  const FrameFacts facts{.first = !results.picture.radiance,
                         .settingsChanged = settingsChanged,
                         .drawingChanged = drawingChanged,
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
  CpuScope scope(stats.stages, key(StageId::Scene));
  const SceneView& view = world.view;
  using enum EffectId;
  const AlphaTest alpha = !plan.on(Alpha) ? AlphaTest::None : plan.idle(Alpha) ? AlphaTest::All : AlphaTest::Masked;
  rays->setAlphaTest(alpha);
  gpuScene->setAlphaTest(alpha);
  rays->setTextures(plan.on(Textures));
  work(Motion) = rays->update(view, plan.idle(Motion));
  gpuScene->place(view.instances);
  disturbance = Disturbance(view);
  lights = collectLights(view);
  if (!plan.on(Emissive)) {
    lights.emitters.clear();
    lights.triangles.clear();
    lights.emission = false;
  }
  if (!plan.on(Sky)) lights.sky = vec3(0);
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
const std::vector<std::string> kBufferNames = {"beauty",      "direct",  "indirect", "irradiance", "albedo",
                                               "normal",      "depth",   "emission", "unfiltered", "vpls",
                                               "shadow-maps", "patches", "nan"};
}

const std::vector<std::string>& bufferNames() { return kBufferNames; }

Buffer bufferByName(const std::string& name) {
  for (size_t i = 0; i < kBufferNames.size(); ++i)
    if (kBufferNames[i] == name) return Buffer(i);
  const std::string near = nearestName(name, kBufferNames);
  throw InputError("--buffer " + name,
                   "no such buffer (" + (near.empty() ? "beauty, direct, …" : "did you mean " + near + "?") + ")");
}

Image GiFrame::read(Buffer buffer) const {
  const gl::StateGuard guard;
  return readBuffer(buffer, state_->results);
}

Image8 GiFrame::readDisplay(Buffer buffer) const {
  const gl::StateGuard guard;
  if (buffer == Buffer::Vpls) state_->finishUpdate();
  state_->displayPass.run(buffer, state_->results, state_->exposure, state_->settings.debug.nan);
  return state_->displayPass.read();
}

void GiFrame::present(Buffer buffer, uint32_t framebuffer, int width, int height) const {
  const gl::StateGuard guard;
  if (buffer == Buffer::Vpls) state_->finishUpdate();
  state_->displayPass.run(buffer, state_->results, state_->exposure, state_->settings.debug.nan);
  state_->displayPass.present(framebuffer, width, height);
}

ShadowAgreement GiFrame::compareShadowMaps(const SceneView& view, int slots, int points,
                                           const std::function<void(int, int)>& progress) {
  State& s = *state_;
  const gl::StateGuard guard;
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
