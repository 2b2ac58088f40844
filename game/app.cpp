#include "game/app.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/interrupt.h"
#include "engine/gl/state_guard.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr double kTestFrameSeconds = 1.0 / 30; // scene time per frame under --frames
constexpr double kTurnSeconds = 1.0 / 60;      // of the window while nothing is played
constexpr double kProgressSeconds = 0.1;       // between frames of the progress: the CPU draws them, too
using Clock = std::chrono::steady_clock;

constexpr std::pair kWindow = {1280, 720};

GlContext openWindow(const LaunchOptions& launch, const Preferences& preferences) {
  useThreads(launch.threads); // before there is a context
  const bool asked = !launch.size.empty();
  const auto [width, height] = asked ? sizeOf(launch.size) : preferences.window.value_or(kWindow);
  return GlContext::window("Lambent", width, height, asked);
}

/// Files of the bundled scenes, and of those that `lambent content` has made next to them: content/NAME/NAME.gltf, by
/// name. Empty where there is no such folder.
std::vector<std::string> bundledScenes() {
  std::vector<std::string> scenes;
  try {
    std::error_code failure;
    for (const auto& entry : fs::directory_iterator(findContentFolder(), failure)) {
      const fs::path file = entry.path() / entry.path().filename().replace_extension(".gltf");
      if (std::error_code none; fs::exists(file, none)) scenes.push_back(file.string());
    }
  } catch (const InputError&) { // there is no folder; files can still be dropped
  }
  std::ranges::sort(scenes);
  return scenes;
}

fs::path preferencesFile(const GameOptions& options) {
  if (options.fresh || options.frames) return {};
  return lambent::preferencesFile(std::getenv("XDG_CONFIG_HOME"), std::getenv("HOME"));
}

} // namespace

App::App(const GameOptions& options)
    : options_(options), preferences_(preferencesFile(options)), context_(openWindow(options.launch, preferences_.now)),
      hud_(context_.handle()), input_(context_.handle()), scenes_(bundledScenes()) {
  input_.script(options.press);
  keepPreferences(0); // says what is wrong with them
  glfwSetWindowUserPointer(context_.handle(), &dropped_);
  glfwSetDropCallback(context_.handle(), [](GLFWwindow* window, int count, const char** files) {
    auto& dropped = *static_cast<std::deque<std::string>*>(glfwGetWindowUserPointer(window));
    for (int i = 0; i < count; ++i) dropped.push_back(files[i]);
  });
  if (!options_.frames) glfwSwapInterval(1); // a still frame need not be shown a thousand times a second
}

App::~App() = default;

void App::run() {
  if (options_.frames == 0) return; // tools/demo asks only whether a window can be opened
  open(options_.launch.scene, true);
  tellOfCutRecordings();
  auto before = Clock::now();
  while (!context_.shouldClose() && !interrupted && (!options_.frames || frames_ < *options_.frames)) {
    context_.poll();
    std::erase_if(cancelled_, [](const auto& loading) { return loading->done(); });
    if (!dropped_.empty()) {
      open(dropped_.back());
      dropped_.clear();
    }
    const auto now = Clock::now();
    const double seconds = options_.fps      ? 1 / *options_.fps
                           : options_.frames ? kTestFrameSeconds
                                             : std::chrono::duration<double>(now - before).count();
    before = now;
    keepPreferences(seconds);
    if (loading_) {
      load();
      before = Clock::now(); // the first frame is not as long as that took
    } else if (play_)
      play(seconds);
    else
      choose();
  }
  endedInOrder();
  if (play_ && !options_.screenshot.empty()) play_->writeScreenshot(options_.screenshot);
  play_.reset(); // with what it records
  preferences_.save();
  if (const std::string complaint = preferences_.takeComplaint(); !complaint.empty())
    std::cerr << "warning: " << printable(complaint) << "\n";
  // What is still read is given up at its next step, which may be a long one.
  endSoon();
  cancelLoading();
  cancelled_.clear();
  endedInOrder();
}

/// A program that was killed did not end its recording.
void App::tellOfCutRecordings() {
  for (const fs::path& walk : endCutShots(fs::absolute("out"))) {
    const std::string line = "a recording was cut short: what it has is in " + walk.string();
    std::cerr << printable(line) << "\n";
    hud_.say(line);
  }
}

/// What the person changes, the window's size too, is there again the next time.
void App::keepPreferences(double seconds) {
  int width = 0, height = 0;
  glfwGetWindowSize(context_.handle(), &width, &height);
  const std::pair size(width, height);
  const bool small = width < 160 || height < 90; // not one that somebody wants to begin with
  if (size != windowSize_.value_or(size) && !small) preferences_.now.window = size;
  windowSize_ = size;
  preferences_.passed(seconds);
  if (const std::string complaint = preferences_.takeComplaint(); !complaint.empty()) {
    std::cerr << "warning: " << printable(complaint) << "\n";
    hud_.say(complaint);
  }
}

/// Gives up what is there for another scene.
void App::open(const std::string& file, bool given) {
  cancelLoading();
  play_.reset();
  input_.release();
  menu_ = preparing_ = false;
  given_ = given;
  LaunchOptions launch = options_.launch;
  launch.scene = file;
  if (!given) launch.trust = {}; // the command line trusts its own
  gap_ = {};
  loading_ = std::make_unique<Loading>(launch);
}

void App::cancelLoading() {
  if (!loading_) return;
  loading_->cancel();
  cancelled_.push_back(std::move(loading_));
}

void App::load() {
  if (!loading_->done()) {
    if (input_.escape()) {
      hud_.say("cancelled: " + fs::path(loading_->file()).filename().string());
      cancelLoading();
      return;
    }
    showProgress(loading_->progress());
    glfwWaitEventsTimeout(kTurnSeconds);
    return;
  }
  const std::unique_ptr<Loading> loading = std::move(loading_);
  gap_.add(loading->gap());
  try {
    prepare(loading->take());
  } catch (const RunError& e) {
    if (!beginsWithDefaults(loading->file(), e)) throw;
  } catch (const InputError& e) {
    if (beginsWithDefaults(loading->file(), e)) return;
    if (given_) throw; // the command line asked for it
    hud_.say(e.what());
  } catch (const Cancelled&) {
    play_.reset();
    hud_.say("cancelled: " + fs::path(loading->file()).filename().string());
  }
}

/// What the person chose the last time, and this machine has no memory for, must not keep a scene from being opened. It
/// stays kept.
bool App::beginsWithDefaults(const std::string& file, const std::exception& why) {
  if (!play_ || options_.defaults || !preferences_.now.chooseQuality()) return false; // something else is wrong
  const std::string line = std::string("settings of the last time are left out: ") + why.what();
  std::cerr << "warning: " << printable(line) << "\n";
  options_.defaults = true;
  open(file, given_);
  hud_.say(line);
  return true;
}

/// Draws the first frames, the window going on between their parts.
void App::prepare(LoadedScene loaded) {
  gap_.at("player");
  preparing_ = true;
  play_ = std::make_unique<Play>(options_, context_, hud_, preferences_.now, std::move(loaded));
  glfwSetWindowTitle(context_.handle(), ("Lambent: " + play_->name()).c_str());
  auto polled = Clock::now(), shown = polled - std::chrono::seconds(1);
  play_->prepare(
      [&](const Progressed& progress) {
        const bool quietly = progress.at.empty();
        gap_.at(quietly ? "second frame" : progress.at);
        const auto passed = [](Clock::time_point since, double seconds) {
          return Clock::now() - since >= std::chrono::duration<double>(seconds);
        };
        if (!passed(polled, kTurnSeconds)) return;
        context_.poll();
        if (input_.escape() || context_.shouldClose() || interrupted || !dropped_.empty()) throw Cancelled();
        polled = Clock::now();
        if (quietly || !passed(shown, kProgressSeconds)) return;
        showProgress(progress);
        shown = Clock::now();
      },
      [&] { hud_.keepFrame(); });
  preparing_ = false;
  gap_.end();
  hud_.forgetFrame();
}

void App::showProgress(const Progressed& progress) {
  const gl::StateGuard guard; // it may be called in the midst of a pass
  hud_.begin();
  hud_.drawProgress(loading_ ? fs::path(loading_->file()).filename().string() : play_->name(), progress.at,
                    progress.share);
  show();
  writeState();
}

void App::show() {
  const auto [width, height] = context_.framebufferSize();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0.06f, 0.06f, 0.07f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  hud_.end();
  context_.swap();
}

/// No scene is open: one is to be chosen.
void App::choose() {
  if (input_.escape()) glfwSetWindowShouldClose(context_.handle(), GLFW_TRUE);
  hud_.begin();
  const MenuChoice choice = hud_.drawMenu(scenes_, false);
  show();
  writeState();
  obey(choice);
  glfwWaitEventsTimeout(kTurnSeconds);
}

void App::play(double seconds) {
  const auto [width, height] = context_.framebufferSize();
  if (width == 0 || height == 0) { // minimised
    glfwWaitEventsTimeout(0.1);
    return;
  }
  Wishes wishes = input_.read(hud_.keysTaken(), hud_.mouseTaken(), !menu_ && !play_->mouseDivides(), float(seconds));
  if (std::exchange(wishes.menu, false)) menu_ = !menu_;
  if (menu_) {
    input_.release();
    wishes = {}; // what is pressed now is not for the scene
    seconds = 0;
  }
  hud_.begin();
  const MenuChoice choice = menu_ ? hud_.drawMenu(scenes_, true) : MenuChoice{};
  play_->frame(wishes, seconds);
  hud_.end();
  ++frames_;
  if (options_.frames == frames_ && !options_.screenshot.empty()) {
    play_->writeScreenshot(options_.screenshot);
    options_.screenshot.clear();
  }
  context_.swap();
  writeState();
  obey(choice);
}

void App::obey(const MenuChoice& choice) {
  menu_ &= !choice.resume && !choice.restart && !choice.home;
  if (choice.restart) play_->restart();
  if (choice.home) play_->home();
  if (choice.quit) glfwSetWindowShouldClose(context_.handle(), GLFW_TRUE);
  if (!choice.scene.empty()) open(choice.scene);
}

/// For tests that press keys: what became of them.
void App::writeState() const {
  if (options_.state.empty()) return;
  const char* phase = loading_     ? "loading"
                      : !play_     ? "choosing"
                      : preparing_ ? "preparing"
                      : menu_      ? "menu"
                                   : "playing";
  std::string said;
  for (const char c : hud_.lastSaid())
    if (c != '"' && c != '\\') said += c;
  writeAtomically(options_.state, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << "{\"phase\": \"" << phase << "\", \"frames\": " << frames_ << ", \"said\": \"" << said
        << "\", \"longest_gap_ms\": " << gap_.ms() << ", \"longest_gap_in\": \"" << gap_.where() << "\", \"at\": \""
        << gap_.now() << "\"";
    const auto [width, height] = context_.framebufferSize();
    out << ", \"window\": [" << width << ", " << height << "], \"display_scale\": " << hud_.scale()
        << ", \"focused\": " << (glfwGetWindowAttrib(context_.handle(), GLFW_FOCUSED) ? "true" : "false");
    if (play_) out << ", \"scene\": \"" << play_->name() << "\"";
    if (play_ && !preparing_ && frames_) out << ", " << play_->state();
    out << "}\n";
  });
}

} // namespace lambent
