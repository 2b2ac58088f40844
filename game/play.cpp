#include "game/play.h"

#include "engine/core/error.h"
#include "engine/gl/objects.h"
#include "engine/gl/pulse.h"
#include "gi/plan/needs.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

// A slow frame must not turn one key press into a jump through a door.
constexpr float kLongestStep = 0.25f; // seconds
constexpr int kRoughWarmup = 12;      // iterations before the first frame
constexpr float kRoughScale = 0.35f;  // of its width and height

constexpr double kHoursPerSecond = 0.25; // of a day that runs by itself
constexpr double kMorning = 9;           // that it begins at
constexpr float kTorch = 5;              // intensity in its middle, of a lamp's

constexpr const char *kGaits[] = {"walk", "fly", "ghost"},
                     *kGaitTexts[] = {"walking", "flying: walls stop you", "flying through walls"};

AskedFor askedFor(const LaunchOptions& launch) {
  AskedFor asked{!launch.preset.empty() || !launch.technique.empty(), {}};
  for (const std::string& text : launch.set) asked.settings.push_back(text.substr(0, text.find('=')));
  if (launch.bounces) asked.settings.push_back("smc.bounces");
  return asked;
}

} // namespace

Play::Play(const GameOptions& options, GlContext& context, Hud& hud, Preferences& preferences, LoadedScene loaded)
    : options_(options), context_(context), hud_(hud), preferences_(preferences), stage_(std::move(loaded.stage)),
      props_(*stage_->props), solids_(std::move(loaded.solids)), goal_(std::move(loaded.goal)), shot_(stage_->shot),
      scene_(stage_->scene), diameter_(worldBounds(scene_).diameter()), player_(stage_->camera, worldBounds(scene_)),
      gi_(preferred(), stage_->seed,
          options.fps ? Makers::ByRule : Makers::Measured), // a replay is that of lambent record
      truth_(stage_->seed) {
  for (const std::string& warning : scene_.warnings) std::cerr << "warning: " << printable(warning) << "\n";
  for (const std::string& note : stage_->notes) hud_.say(note);
  // A warm lamp that lights its surroundings as brightly in a doll's house as in a hall.
  model_.lampIntensity = vec3(1, 0.75f, 0.5f) * glm::max(0.004f * diameter_ * diameter_, 1e-6f);
  // What a person chose is not chosen again.
  const LaunchOptions& launch = options.launch;
  const bool asked = !launch.preset.empty() || !launch.set.empty() || !launch.technique.empty();
  model_.pacer = Pacer(options.targetMs, !asked && !preferences.chooseQuality());
  if (options.fps && !options.targetMs) model_.pacer.hold(1); // a replay is drawn in full
  model_.buffer = bufferByName(options.buffer);
  model_.preset = !launch.preset.empty() || !launch.technique.empty() ? launch.preset : preferences.preset;
  model_.panel = preferences.panel;
  model_.folded = preferences.folded;
  model_.speed = float(preferences.speed);
  if (shot_ && !shot_->camera.empty()) path_ = *shot_;
  double longest = 0;
  for (const AnimationClip& clip : scene_.animations) longest = std::max(longest, clip.duration);
  const double duration = shot_ ? shot_->seconds : longest;
  model_.duration = duration > 0 ? duration : 1;
  restart();
  if (!options.truth.empty()) showTruth(options.truth == "heat" ? TruthMode::Heat : TruthMode::Split);
}

Play::~Play() {
  if (!recorder_.recording()) return;
  toggleRecording(); // what was walked is not lost
  std::cerr << hud_.lastSaid() << "\n";
}

void Play::restart() {
  if (recorder_.recording()) toggleRecording();
  model_.time = 0;
  model_.paused = model_.torch = false;
  props_.movers.reset();
  props_.things.clear();
  pose(0);
  home();
  model_.followPath = path_.has_value() && !stage_->cameraGiven;
  if (model_.followPath) pose(0); // as it was played
  if (!goal_) return;
  goal_->reset();
  hud_.say("bring daylight to the " + goal_->what() + " with doors (E) and white boards (B); lamps do not count");
}

void Play::home() {
  model_.followPath = false;
  player_.home(solids_->rays());
}

void Play::prepare(const std::function<void(const Progressed&)>& progress, const std::function<void()>& shown) {
  const Settings wanted = gi_.settings();
  Progressed last{"shaders and textures", 0};
  const auto report = [&](const char* at, float from, float to) {
    return [&last, &progress, at, from, to](int done, int total) {
      last = {at, from + (to - from) * float(done) / float(std::max(total, 1))};
      progress(last);
    };
  };
  progress(last);
  std::optional<gl::Pulse> pulse;
  pulse.emplace([&] { progress(last); });
  const auto [width, height] = context_.framebufferSize();
  Settings rough = wanted; // what a slow machine will keep, as far as it can
  applyPreset(rough, presetTable().front().name);
  rough.gather.mode = wanted.gather.mode;
  rough.smc.warmup = kRoughWarmup;
  const bool roughFirst =
      !options_.frames && !options_.fps && wanted.smc.vpls > 2 * rough.smc.vpls && wanted.smc.warmup > kRoughWarmup;
  if (roughFirst) {
    gi_.settings() = rough;
    gi_.settings().gather.near = 0;
    gi_.run(viewAt(kRoughScale), report("first lights", 0.1f, 0.3f));
    pulse.emplace([&] { progress({}); }); // what follows is timed
    gi_.present(model_.buffer, 0, width, height);
    shown();
    // The second of a kind says what frames cost: shaders are compiled, maps are drawn.
    gi_.settings() = rough;
    const FrameStats& stats = gi_.run(viewAt(0.99f * kRoughScale));
    // By lists a pixel gathers as many lights whatever there are.
    const double gather = stats.ms(StageId::Gather),
                 lights = needsOf(wanted).lists ? 1 : double(wanted.smc.vpls) / rough.smc.vpls;
    gi_.settings() = wanted;
    model_.pacer.expect((stats.costMs() + gather * (lights - 1)) / double(kRoughScale * kRoughScale), gi_.settings());
    if (!model_.pacer.preset().empty()) model_.preset = model_.pacer.preset();
    rough.smc.warmup = wanted.smc.warmup;
    if (gi_.settings() == rough) {
      showPreferredExposure();
      return tellWhereItIsDark();
    }
    pulse.emplace([&] { progress(last); });
  }
  gi_.run(viewAt(model_.pacer.scale()), report("all lights", roughFirst ? 0.3f : 0.1f, 1));
  showPreferredExposure();
  tellWhereItIsDark();
}

/// Somebody who sees nothing must not think that nothing works.
void Play::tellWhereItIsDark() {
  const Image image = gi_.read(Buffer::Beauty);
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) sum += double(luminance(vec3(image.at(x, y))));
  if (sum * double(gi_.exposure()) < 2e-3 * image.width * image.height)
    hud_.say("it is dark here: Q is a flashlight, L a lamp, E opens doors, ] brightens the image");
}

/// The stage's settings as the person left them the last time.
Settings Play::preferred() {
  constexpr float kAdaptation = 2; // seconds
  const std::vector<std::string> asked = askedFor(options_.launch).settings;
  adapts_ = !options_.frames && !options_.fps && std::ranges::find(asked, "image.adaptation") == asked.end() &&
            !(shot_ && shot_->set.contains("image.adaptation"));
  if (adapts_) stage_->settings.image.adaptation = kAdaptation;
  if (options_.defaults) return stage_->settings;
  std::string complaint;
  const auto technique = [](Settings& s, const std::string& name) { applyTechnique(s, name); };
  const Settings settings = preferences_.over(stage_->settings, askedFor(options_.launch), technique, complaint);
  if (!complaint.empty()) stage_->notes.push_back(complaint);
  if (settings == stage_->settings) return settings;
  stage_->notes.push_back("settings are as you left them (panel: back to defaults)");
  if (settings.vpl.source != stage_->settings.vpl.source) tellWhatIsLeftOut(*stage_, settings);
  return settings;
}

/// Brighter or darker than the scene is by itself, once that is known.
void Play::showPreferredExposure() {
  ownExposure_ = gi_.exposure();
  const std::vector<std::string> asked = askedFor(options_.launch).settings;
  if (preferences_.exposure != 0 && std::ranges::find(asked, "image.exposure") == asked.end())
    gi_.settings().image.exposure = ownExposure_ * float(std::exp2(preferences_.exposure));
}

/// What differs from before is the person's doing.
void Play::keepChanges(const Settings& before, const std::string& presetBefore) {
  const Settings& now = gi_.settings();
  preferences_.panel = model_.panel;
  preferences_.folded = model_.folded;
  preferences_.speed = double(model_.speed);
  if (now == before && model_.preset == presetBefore) return;
  if (now.image.exposure != before.image.exposure && now.image.exposure > 0)
    preferences_.exposure = std::clamp(std::log2(double(now.image.exposure) / double(ownExposure_)), -24.0, 24.0);
  Settings other = before;
  applyTechnique(other, techniqueOf(now));
  if (model_.preset != presetBefore)
    preferences_.chosePreset(model_.preset, before, now);
  else if (techniqueOf(now).name != techniqueOf(before).name && other == now)
    preferences_.choseTechnique(techniqueOf(now).name, before, now);
  else
    preferences_.changed(before, now);
}

/// All as it would be if the person had never changed anything.
void Play::forgetChanges() {
  const auto window = preferences_.window;
  preferences_ = {};
  preferences_.window = window;
  gi_.settings() = stage_->settings;
  if (stage_->settings.image.exposure <= 0 && stage_->settings.image.adaptation <= 0)
    gi_.settings().image.exposure = ownExposure_;
  const LaunchOptions& launch = options_.launch;
  model_.pacer = Pacer(options_.targetMs, launch.preset.empty() && launch.set.empty() && launch.technique.empty());
  model_.preset = launch.preset;
  model_.speed = 1;
  model_.folded.reset();
  hud_.say("all settings are the defaults again");
}

void Play::pose(double seconds) {
  if (shot_)
    poseShot(scene_, *shot_, model_.time);
  else
    animate(scene_, model_.time);
  if (model_.hour && model_.dayRuns && !model_.paused)
    model_.hour = std::fmod(*model_.hour + kHoursPerSecond * seconds, 24.0);
  if (followsMoments()) {
    followMoment();
  } else {
    if (props_.day.hour() != model_.hour) props_.day.set(model_.hour);
    props_.day.apply();
    props_.movers.update(std::min(seconds, double(kLongestStep)));
  }
  solids_->update();
}

SceneView Play::viewAt(float scale) {
  const auto [width, height] = context_.framebufferSize();
  if (model_.followPath) player_.place(shotCamera(*path_, model_.time, scene_.origin));
  const CameraView camera = player_.view(std::max(width, 1), std::max(height, 1));
  return extractor_.extract(scene_, camera.scaled(scale), model_.time);
}

void Play::frame(const Wishes& wishes, double seconds) {
  if ((!options_.frames && !options_.fps) || options_.targetMs) pace(seconds);
  const auto keeping = [&](const auto& action) {
    const Settings before = gi_.settings();
    const std::string preset = model_.preset;
    action();
    keepChanges(before, preset);
  };
  keeping([&] { obey(wishes, float(seconds)); });
  // What is recorded at fixed steps stands still as a whole where no time goes by: its replay knows nothing of that.
  const bool frozen =
      recorder_.recording() && options_.fps && recorder_.frames() > 0 && (model_.paused || seconds == 0);
  if (!frozen) keeping([&] { step(wishes, seconds); });
  const FrameStats& stats = gi_.stats();
  const auto now = std::chrono::steady_clock::now();
  const std::chrono::duration<double> real = now - std::exchange(frameBegan_, now);
  times_.add(std::min(real.count(), 1.0), stats); // also where scene time goes by in steps
  const auto [width, height] = context_.framebufferSize();
  truth_.update(view_, gi_, stats, model_.buffer, options_.frames.has_value());
  truth_.present(gi_, model_.buffer, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  model_.hasPath = path_.has_value();
  model_.recordedSeconds = recorder_.recording() ? std::optional(recorder_.seconds()) : std::nullopt;
  model_.gait = player_.gait();
  model_.offer = offer();
  if (model_.buffer == Buffer::Vpls && truth_.mode() == TruthMode::Off)
    drawVplAtCrosshair(gi_, view_.camera, hud_.scale());
  keeping([&] { hud_.draw(model_, scene_, gi_, truth_, stats, times_); });
  if (std::exchange(model_.backToDefaults, false)) forgetChanges();
  player_.pace = model_.speed;
  if (wishes.screenshot) saveScreenshot();
}

/// The scene and the person in it go on by so many seconds, and GI draws them.
void Play::step(const Wishes& wishes, double seconds) {
  const bool begins = recorder_.recording() && recorder_.frames() == 0;
  if (!model_.paused && !begins) {
    model_.time = recorder_.recording() && options_.fps ? double(recorder_.frames()) / *options_.fps // not a sum
                                                        : model_.time + seconds;
    if (!recorder_.recording()) model_.time = std::fmod(model_.time, model_.duration);
  }
  pose(seconds);
  movePlayer(wishes, float(seconds));
  if (!followsMoments()) {
    handle(wishes);
    props_.things.lampIntensity = model_.lampIntensity;
    props_.things.update(*solids_, player_, std::min(float(seconds), kLongestStep));
    carryTorch();
  }
  if (goal_) measureGoal();
  const bool recorded = recordFrame();

  const auto [width, height] = context_.framebufferSize();
  CameraView camera = player_.view(width, height);
  if (recorded) {
    camera = recorder_.camera(scene_.origin);
    camera.width = width;
    camera.height = height;
  }
  view_ = extractor_.extract(scene_, camera.scaled(model_.pacer.scale()), model_.time);
  gi_.passTime(seconds);
  run(view_);
  if (recorded) logFrame();

  const SceneChanges& c = view_.changes;
  const mat4 pose = view_.camera.worldFromView; // the camera changes also where the scale does
  moved_ = pose != std::exchange(pose_, pose) || c.lights || c.geometry || c.instances;
}

/// Settings that cannot be, or that this machine has no memory for, give way to those of the frame before.
void Play::run(const SceneView& view) {
  const Settings wanted = gi_.settings();
  const auto runWith = [&](const Settings& settings) {
    gi_.settings() = settings;
    if (model_.lightsStay) gi_.settings().smc.moves = 0; // for this frame: it is no setting that is kept or recorded
    gi_.run(view);
    gi_.settings().smc.moves = settings.smc.moves;
    drawnWith_ = settings;
  };
  const auto goBack = [&](const std::exception& e) {
    if (!drawnWith_ || *drawnWith_ == wanted) throw;
    hud_.say(std::string(e.what()) + ": the settings are as before");
    runWith(Settings(*drawnWith_));
  };
  try {
    runWith(wanted);
  } catch (const InputError& e) {
    goBack(e);
  } catch (const RunError& e) {
    goBack(e);
  }
}

void Play::obey(const Wishes& wishes, float seconds) {
  const bool hands = wishes.use || wishes.hurl || wishes.lamp || wishes.box || wishes.torch || wishes.dayRuns;
  if (hands && followsMoments()) takeOver();
  model_.paused ^= wishes.pause;
  model_.help ^= wishes.help;
  model_.panel ^= wishes.panel;
  model_.torch ^= wishes.torch;
  if (wishes.dayRuns) {
    model_.dayRuns = !model_.dayRuns || !model_.hour;
    if (!model_.hour) model_.hour = kMorning;
  }
  if (wishes.restart) restart();
  if (wishes.home) {
    home();
    hud_.say("back where you began");
  }
  if (wishes.gait) {
    player_.setGait(Gait((int(player_.gait()) + 1) % 3));
    hud_.say(kGaitTexts[int(player_.gait())]);
  }
  if (wishes.followPath) toggleFollowing();
  if (wishes.record) toggleRecording();
  if (wishes.buffer && *wishes.buffer < int(bufferNames().size())) model_.buffer = Buffer(*wishes.buffer);
  if (wishes.exposure != 0) gi_.settings().image.exposure = gi_.exposure() * std::exp2(float(wishes.exposure) / 3);
  if (wishes.truth) showTruth(TruthMode((int(truth_.mode()) + 1) % 3));
  if (truth_.mode() == TruthMode::Split) {
    constexpr float kSharePerSecond = 0.5f;
    const float moved = truth_.divider + kSharePerSecond * std::min(seconds, kLongestStep) * wishes.divider;
    truth_.divider = wishes.dividerAt.value_or(glm::clamp(moved, 0.0f, 1.0f));
  }
  if (wishes.reloadShaders) {
    const std::vector<std::string> messages = gi_.reloadShaders();
    for (const std::string& message : messages) hud_.say(message);
    if (messages.empty()) hud_.say("no shader file has changed");
  }
}

/// Along the path, until the person takes over.
void Play::movePlayer(const Wishes& wishes, float seconds) {
  if (model_.followPath && wishes.move.any()) takeOver();
  if (model_.followPath)
    player_.place(shotCamera(*path_, model_.time, scene_.origin));
  else if (player_.move(solids_->rays(), solids_->view(), wishes.move, std::min(seconds, kLongestStep)))
    hud_.say("you fell out of the scene: back where you began");
  const bool before = std::exchange(cramped_, player_.body().cramped(solids_->rays()));
  if (cramped_ && !before) props_.movers.turnBack(); // nobody is crushed
}

/// By what the frame before took: all of it, panel and window too, but where seconds are not the clock's.
void Play::pace(double seconds) {
  const std::string before = model_.pacer.preset();
  const double ms = options_.frames || options_.fps ? 0 : 1000 * seconds;
  model_.pacer.took(gi_.stats(), ms, moved_, gi_.settings());
  const std::string& now = model_.pacer.preset();
  if (now == before) return;
  model_.preset = now;
  hud_.say("preset " + now + ": the dearest that this machine draws in time");
}

/// A truth accumulates while nothing moves: time stands still with it, and goes on after it.
void Play::showTruth(TruthMode mode) {
  const bool was = truth_.mode() != TruthMode::Off, is = mode != TruthMode::Off;
  truth_.set(mode);
  if (was == is) return;
  if (is && !model_.paused) hud_.say("time stands still for the truth (P lets it run)");
  model_.paused = is ? (pausedBefore_ = model_.paused, true) : pausedBefore_;
}

/// The torch shines from beside the eyes to where they look.
void Play::carryTorch() {
  if (!model_.torch) return props_.setTorch(std::nullopt);
  const float height = player_.body().size().height;
  const vec3 sideways(std::cos(player_.yaw()), -1, -std::sin(player_.yaw()));
  props_.setTorch(PlayedMoment::Torch{player_.position() + 0.04f * height * sideways, player_.forward(),
                                      kTorch * vec3(luminance(model_.lampIntensity))});
}

void Play::measureGoal() {
  const bool before = goal_->reached();
  goal_->update();
  if (goal_->reached() && !before)
    hud_.say("it is done: the " + goal_->what() + " has the daylight that it waited for (F2 starts again)");
  model_.goal = GoalShown{goal_->what(), goal_->irradiance(), goal_->wanted(), goal_->reached()};
}

std::string Play::state() const {
  const vec3 p = player_.position(), d = player_.forward();
  char text[1024];
  std::snprintf(text, sizeof text,
                "\"eye\": [%.4f, %.4f, %.4f], \"forward\": [%.4f, %.4f, %.4f], \"gait\": \"%s\", \"grounded\": %s, "
                "\"time\": %.4f, \"paused\": %s, \"following\": %s, \"recorded\": %.3f, \"buffer\": \"%s\", "
                "\"scale\": %.3f, \"exposure\": %.5f, \"things\": %zu, \"carried\": \"%s\", \"offer\": \"%s\", "
                "\"torch\": %s, \"door\": %.3f, \"lift\": %.3f, \"hour\": %.3f, "
                "\"frame_ms\": %.2f",
                double(p.x), double(p.y), double(p.z), double(d.x), double(d.y), double(d.z),
                kGaits[int(player_.gait())], player_.body().grounded() ? "true" : "false", model_.time,
                model_.paused ? "true" : "false", model_.followPath ? "true" : "false",
                recorder_.recording() ? recorder_.seconds() : -1.0, bufferNames()[size_t(model_.buffer)].c_str(),
                double(model_.pacer.scale()), double(gi_.exposure()), props_.things.count(),
                props_.things.carried() ? thingName(*props_.things.carried()) : "", model_.offer.c_str(),
                model_.torch ? "true" : "false", props_.movers.place("door leaf"), props_.movers.place("cabin"),
                model_.hour.value_or(-1), times_.meanMs());
  std::string all = text;
  if (goal_) {
    std::snprintf(text, sizeof text, ", \"goal\": %.6f, \"goal_at\": %.6f, \"reached\": %s",
                  double(goal_->irradiance()), double(goal_->wanted()), goal_->reached() ? "true" : "false");
    all += text;
  }
  for (const FigureColumn& column : columnsOf(gi_.stats()))
    if (column.name.ends_with("_ms")) all += ", \"" + column.name + "\": " + column.text;
  return all + ", \"preset\": \"" + model_.preset + "\", \"own_settings\": " + std::to_string(preferences_.set.size()) +
         ", \"panel\": " + (model_.panel ? "true" : "false") +
         ", \"exposure_ev\": " + std::to_string(preferences_.exposure);
}

} // namespace lambent
