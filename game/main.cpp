// The walkthrough: a window on a scene, a player with a lamp, and a panel over it. Each turn of the loop in
// Walkthrough::frame reads input, poses the scene, runs GI and shows the result.
#include "engine/core/error.h"
#include "engine/gl/objects.h"
#include "engine/platform/gl_context.h"
#include "game/hud.h"
#include "game/interaction.h"
#include "game/pace.h"
#include "game/player.h"
#include "game/truth_view.h"
#include "gi/frame/gi_frame.h"
#include "tools/launch/launch.h"
#include "tools/launch/streams.h"

#include <epoxy/gl.h>

#include <CLI/CLI.hpp>
#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <iostream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr double kTestFrameSeconds = 1.0 / 30; // scene time per frame under --frames

struct GameOptions {
  LaunchOptions launch;
  std::string buffer = "beauty";
  std::optional<double> targetMs; // of a frame
  std::optional<int> frames;      // for tests: quit after so many
  std::string screenshot;         // for tests: what the window shows at the end
  std::string truth;              // for tests: split or heat from the start
};

class Walkthrough {
 public:
  explicit Walkthrough(const GameOptions& options)
      : options_(options), stage_(openStage(options.launch)), shot_(stage_->shot), scene_(stage_->scene),
        diameter_(worldBounds(scene_).diameter()), player_(stage_->camera, diameter_),
        context_(GlContext::window("Lambent", stage_->camera.width, stage_->camera.height)),
        gi_(stage_->settings, stage_->seed), hud_(context_.handle()), interaction_(context_.handle()),
        recorder_(scene_.file), truth_(stage_->seed) {
    for (const std::string& warning : scene_.warnings) std::cerr << "warning: " << printable(warning) << "\n";
    for (const std::string& note : stage_->notes) hud_.say(note);
    // A warm lamp that lights its surroundings as brightly in a doll's house as in a hall.
    model_.lampIntensity = vec3(1, 0.75f, 0.5f) * glm::max(0.004f * diameter_ * diameter_, 1e-6f);
    model_.speed = player_.speed();
    model_.pacer = Pacer(options.targetMs, options.launch.preset.empty());
    model_.buffer = bufferByName(options.buffer);
    if (!options.launch.preset.empty()) model_.preset = options.launch.preset;
    model_.hasPath = shot_ && !shot_->camera.empty();
    model_.followPath = model_.hasPath && !stage_->cameraGiven;
    double longest = 0;
    for (const AnimationClip& clip : scene_.animations) longest = std::max(longest, clip.duration);
    const double duration = shot_ ? shot_->seconds : longest;
    model_.duration = duration > 0 ? duration : 1;
    hud_.say("F1 shows the keys");
    if (!options.truth.empty()) showTruth(options.truth == "heat" ? TruthMode::Heat : TruthMode::Split);
  }

  void run() {
    auto before = Clock::now();
    for (int i = 0; !context_.shouldClose() && (!options_.frames || i < *options_.frames); ++i) {
      const auto now = Clock::now();
      const double seconds = options_.frames ? kTestFrameSeconds : std::chrono::duration<double>(now - before).count();
      before = now;
      frame(seconds);
      if (options_.frames && i + 1 == *options_.frames && !options_.screenshot.empty())
        writeScreenshot(options_.screenshot);
      context_.swap();
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  void pace(const FrameStats& stats, bool moved) {
    const std::string before = model_.pacer.preset();
    model_.pacer.took(stats, moved, gi_.settings());
    const std::string& now = model_.pacer.preset();
    if (now == before) return;
    model_.preset = now;
    hud_.say("preset " + now + ": the dearest that this machine draws in time");
  }

  void pose(double time) {
    if (shot_)
      poseShot(scene_, *shot_, time);
    else
      animate(scene_, time);
  }

  void frame(double seconds) {
    context_.poll();
    obey(interaction_.read(hud_.keysTaken(), hud_.mouseTaken()), float(seconds));
    if (!model_.paused) model_.time = std::fmod(model_.time + seconds, model_.duration);
    carryLamp();
    pose(model_.time);

    const auto [windowWidth, windowHeight] = context_.framebufferSize();
    if (windowWidth == 0 || windowHeight == 0) { // minimised
      glfwWaitEventsTimeout(0.1);
      return;
    }
    if (model_.followPath) player_.place(shotCamera(*shot_, model_.time, scene_.origin));
    const SceneView view =
        extractor_.extract(scene_, player_.view(windowWidth, windowHeight).scaled(model_.pacer.scale()), model_.time);
    const FrameStats& stats = gi_.run(view, [this](int done, int total) { showProgress(done, total); });

    const SceneChanges& c = view.changes;
    const mat4 pose = view.camera.worldFromView; // the camera changes also where the scale does
    const bool moved = pose != std::exchange(pose_, pose) || c.lights || c.geometry || c.instances;
    if (!options_.frames || options_.targetMs) pace(stats, moved);
    truth_.update(view, gi_, stats, model_.buffer, options_.frames.has_value());
    truth_.present(gi_, model_.buffer, windowWidth, windowHeight);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, windowWidth, windowHeight);
    hud_.draw(model_, gi_, truth_, stats);
    if (screenshotWanted_) report([&] { return saveNumberedScreenshot(); });
  }

  /// Tells the person what `action` did, or why it failed; a full disk must not end the walk.
  template <class Action> void report(Action&& action) {
    try {
      hud_.say(action());
    } catch (const RunError& e) {
      hud_.say(e.what());
    }
  }

  void obey(const Wishes& wishes, float seconds) {
    if (wishes.quit) glfwSetWindowShouldClose(context_.handle(), GLFW_TRUE);
    model_.paused ^= wishes.pause;
    model_.help ^= wishes.help;
    model_.panel ^= wishes.panel;
    model_.lamp ^= wishes.lamp;
    if (wishes.followPath && model_.hasPath) model_.followPath = !model_.followPath;
    if (wishes.move.any()) model_.followPath = false; // the player takes over where the path is
    // A slow frame must not turn one key press into a jump through the wall.
    constexpr float kLongestStep = 0.25f;
    player_.setSpeed(model_.speed);
    player_.move(wishes.move, std::min(seconds, kLongestStep));
    if (wishes.truth) showTruth(nextMode(truth_.mode()));
    if (truth_.mode() == TruthMode::Split) {
      constexpr float kSharePerSecond = 0.5f;
      truth_.moveDivider(kSharePerSecond * std::min(seconds, kLongestStep) * wishes.divider);
      truth_.divider = wishes.dividerAt.value_or(truth_.divider);
    }
    screenshotWanted_ = wishes.screenshot;
    if (wishes.recordKey) report([&] { return recorder_.addKey(player_, scene_.origin); });
    if (wishes.reloadShaders) {
      const std::vector<std::string> messages = gi_.reloadShaders();
      for (const std::string& message : messages) hud_.say(message);
      if (messages.empty()) hud_.say("no shader file has changed");
    }
  }

  /// A truth accumulates while nothing moves: time stands still with it, and goes on after it.
  void showTruth(TruthMode mode) {
    const bool was = truth_.mode() != TruthMode::Off, is = mode != TruthMode::Off;
    truth_.set(mode);
    if (was == is) return;
    if (is && !model_.paused) hud_.say("time stands still for the truth (P lets it run)");
    model_.paused = is ? (pausedBefore_ = model_.paused, true) : pausedBefore_;
  }

  /// Keeps a point light a little below and before the player's eyes while the lamp is carried.
  void carryLamp() {
    if (!model_.lamp) {
      if (lamp_) scene_.registry.destroy(*lamp_);
      lamp_.reset();
      return;
    }
    const float reach = 0.01f * diameter_;
    const vec3 hand = player_.position() + reach * player_.forward() - vec3(0, reach, 0);
    if (!lamp_) {
      LightView light;
      light.position = hand;
      light.intensity = model_.lampIntensity;
      lamp_ = addLight(scene_, light, "carried lamp");
    }
    scene_.registry.get<Transform>(*lamp_).translation = scene_.origin + dvec3(hand);
    scene_.registry.get<PunctualLight>(*lamp_).intensity = model_.lampIntensity;
  }

  /// While the first picture is prepared: the title tells how far it is, and the window stays alive.
  void showProgress(int done, int total) {
    const std::string title =
        done < total ? "Lambent: placing lights, " + std::to_string(100 * done / std::max(total, 1)) + " %" : "Lambent";
    glfwSetWindowTitle(context_.handle(), title.c_str());
    context_.poll();
  }

  /// What the window shows now, the panel included.
  void writeScreenshot(const fs::path& file) const {
    const auto [width, height] = context_.framebufferSize();
    Image8 picture;
    picture.width = width;
    picture.height = height;
    picture.rgb = gl::readWindow(width, height);
    const size_t row = size_t(3) * width;
    for (int y = 0; y < height / 2; ++y) // GL's first row is the lowest
      std::swap_ranges(picture.rgb.begin() + y * row, picture.rgb.begin() + (y + 1) * row,
                       picture.rgb.begin() + (height - 1 - y) * row);
    writePng(file, picture);
  }

  std::string saveNumberedScreenshot() const {
    std::error_code ignored; // writePng says it when the folder is missing
    fs::create_directories("out", ignored);
    int number = 1;
    const auto name = [&] { return fs::absolute("out/screenshot-" + std::to_string(number) + ".png"); };
    while (fs::exists(name(), ignored)) ++number;
    const fs::path file = name();
    writeScreenshot(file);
    return "screenshot in " + file.string();
  }

  const GameOptions options_;
  const std::unique_ptr<Stage> stage_;
  const std::optional<Shot>& shot_;
  Scene& scene_;
  const float diameter_; // of the scene as it starts, metres
  Player player_;
  GlContext context_;
  GiFrame gi_;
  Hud hud_;
  Interaction interaction_;
  ShotRecorder recorder_;
  SceneExtractor extractor_;
  HudModel model_;
  std::optional<Entity> lamp_;
  mat4 pose_{0}; // of the camera in the last frame
  TruthView truth_;
  bool pausedBefore_ = false; // when the truth was asked for
  bool screenshotWanted_ = false;
};

/// Returns nothing when --help was all that was asked for.
std::optional<GameOptions> readOptions(int argc, char** argv) {
  GameOptions options;
  options.launch.size = "1280x720";
  CLI::App app{"Walk through a scene under global illumination that follows its moving lights and objects.\n"
               "W A S D Q E and the mouse with its right button move; F1 shows all keys.",
               "walkthrough"};
  app.add_option("SCENE", options.launch.scene, "glTF or shot file (default: the bundled hall)");
  addLaunchOptions(app, options.launch);
  app.add_option("--buffer", options.buffer, "what to show first: beauty, indirect, vpls, ...");
  app.add_option("--target-ms", options.targetMs,
                 "choose the preset (where none is given) that fits this time of a frame, and hold it by the picture's "
                 "scale; without, only where frames take longer than 150 ms")
      ->check(CLI::Range(1.0, 10000.0));
  app.add_option("--frames", options.frames)->check(CLI::Range(0, 1000000))->group("");
  app.add_option("--screenshot", options.screenshot)->group("");
  app.add_option("--truth", options.truth)->check(CLI::IsMember({"split", "heat"}))->group("");
  refuseNotANumber(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    app.exit(e);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    std::string text = e.what();
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw InputError("command line", text + " (see walkthrough --help)");
  }
  if (options.launch.scene.empty()) options.launch.scene = (findContentFolder() / "hall/hall.gltf").string();
  return options;
}

} // namespace
} // namespace lambent

int main(int argc, char** argv) {
  lambent::prepareStreams();
  try {
    if (const auto options = lambent::readOptions(argc, argv)) lambent::Walkthrough(*options).run();
    return 0;
  } catch (const lambent::InputError& e) {
    std::cerr << "error: " << e.what() << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "error: " << e.what() << "\n";
    return 1;
  }
}
