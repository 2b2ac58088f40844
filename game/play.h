// One scene being played. Each turn of Play::frame reads what is wished, poses the scene, moves the player, runs GI and
// shows the result.
#pragma once

#include "engine/platform/gl_context.h"
#include "game/hud.h"
#include "game/input.h"
#include "game/loading.h"
#include "game/rules/path_recorder.h"
#include "game/rules/player.h"
#include "game/rules/preferences.h"
#include "game/truth_view.h"
#include "gi/viewer/viewer.h"
#include "tools/launch/frame_log.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>

namespace lambent {

struct GameOptions {
  LaunchOptions launch;
  std::string buffer = "beauty";
  std::optional<double> targetMs; // of a frame
  std::optional<double> fps;      // scene time goes by in steps of 1/fps, however long frames take
  bool fresh = false;             // neither takes nor keeps preferences
  bool defaults = false;          // does not take settings from them
  std::optional<int> frames;      // for tests: quit after so many
  std::string screenshot;         // for tests: what the window shows at the end
  std::string truth;              // for tests: split or heat from the start
  std::string press;              // for tests: keys, as Input::script
  std::string state;              // for tests: a file that says what is going on
};

class Play {
 public:
  /// `preferences`: what is begun with; what a person changes goes there.
  Play(const GameOptions& options, GlContext& context, Hud& hud, Preferences& preferences, LoadedScene loaded);
  ~Play();
  Play(const Play&) = delete;

  /// Draws the first frames: a rough one, which `shown` is called for, then that of all lights. `progress` hears of
  /// both, and may throw to end it; the play is then of no more use. Where it is given nothing, nothing may be drawn.
  void prepare(const std::function<void(const Progressed&)>& progress, const std::function<void()>& shown);
  /// Draws one frame of so many seconds into the window, not yet swapped.
  void frame(const Wishes& wishes, double seconds);

  /// Goes back to how the scene began.
  void restart();
  void home();
  void writeScreenshot(const std::filesystem::path& png) const;
  /// Says whether a click into the image belongs to the divider.
  bool mouseDivides() const { return truth_.mode() == TruthMode::Split; }
  const std::string name() const { return scene_.file.stem().string(); }
  /// For tests: name and value of what is going on, as JSON members.
  std::string state() const;

 private:
  Settings preferred();
  void showPreferredExposure();
  void keepChanges(const Settings& before, const std::string& presetBefore);
  void forgetChanges();
  void step(const Wishes& wishes, double seconds);
  void run(const SceneView& view);
  void tellWhereItIsDark();
  void obey(const Wishes& wishes, float seconds);
  void handle(const Wishes& wishes);
  void use();
  std::string offer() const;
  std::optional<uint32_t> lookedAt() const;
  void pose(double seconds);
  void movePlayer(const Wishes& wishes, float seconds);
  SceneView viewAt(float scale);
  void pace(double seconds);
  void toggleRecording();
  bool recordFrame();
  void logFrame();
  void endRecording(const std::string& why);
  void toggleFollowing();
  void takeOver();
  bool followsMoments() const { return model_.followPath && !path_->played.empty(); }
  void showTruth(TruthMode mode);
  void carryTorch();
  void followMoment();
  void measureGoal();
  void saveScreenshot();
  template <class Action> void report(Action&& action);

  const GameOptions options_;
  GlContext& context_;
  Hud& hud_;
  Preferences& preferences_;
  const std::unique_ptr<LaunchContext> stage_;
  Props& props_;
  const std::unique_ptr<Solids> solids_;
  const std::unique_ptr<Goal> goal_; // null: the scene has none
  const std::optional<Shot>& shot_;
  bool adapts_ = false; // image.adaptation is the window's own; before gi_, which asks for settings
  Scene& scene_;
  const float diameter_; // of the scene as it starts, metres
  Player player_;
  Viewer gi_;
  SceneExtractor extractor_;
  HudModel model_;
  FrameTimes times_;
  float ownExposure_ = 1; // of the scene, without the person's
  PathRecorder recorder_;
  FrameLog log_;                           // of what is recorded
  std::optional<Settings> drawnWith_ = {}; // the last frame
  std::optional<Shot> path_;               // that F follows: of the shot, or recorded
  bool cramped_ = false;                   // something was where the player is
  mat4 pose_{0};                           // of the camera in the last frame
  bool moved_ = false;                     // anything, for the last frame
  SceneView view_;                         // of the last frame
  std::chrono::steady_clock::time_point frameBegan_ = std::chrono::steady_clock::now();
  TruthView truth_;
  bool pausedBefore_ = false; // when the truth was asked for
};

} // namespace lambent
