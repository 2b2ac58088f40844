// What is drawn over the image: the panel, the frame rate, messages, the menu, and how far loading is.
#pragma once

#include "engine/scene/scene.h"
#include "game/pace.h"
#include "game/rules/body.h"
#include "game/truth_view.h"
#include "gi/viewer/viewer.h"

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

struct GLFWwindow;
struct ImVec2;

namespace lambent {

namespace gl {
class Texture;
}

/// How fast frames follow one another, and what they spend their time on: for the corner of the window.
class FrameTimes {
 public:
  /// Adds a frame that came `seconds` after the one before.
  void add(double seconds, const FrameStats& stats);

  struct Frame {
    double wholeMs = 0; // from frame to frame
    double cpuMs = 0, gpuMs = 0;
  };
  const std::deque<Frame>& frames() const { return frames_; } // oldest first
  double meanMs() const;                                      // over the last second

 private:
  static constexpr size_t kMost = 240;
  std::deque<Frame> frames_;
};

/// How far the scene's goal is.
struct GoalShown {
  std::string what;
  float irradiance = 0, wanted = 1; // W/m²
  bool reached = false;
};

/// What panel and keys change and the play obeys.
struct HudModel {
  Buffer buffer = Buffer::Beauty;
  std::string preset = {}; // the last one chosen, empty: none; single settings may differ from it
  bool panel = true, help = false;
  std::optional<bool> folded = {}; // the panel, once a person folded or unfolded it
  bool backToDefaults = false;     // pressed

  double time = 0, duration = 1; // seconds of the scene; the slider's length
  bool paused = false;
  bool hasPath = false, followPath = false; // a camera path: of a shot, or recorded
  std::optional<double> recordedSeconds = {};

  std::optional<double> hour = {}; // of the day, 0 to 24; none: the scene's own light
  bool dayRuns = false;
  bool torch = false;
  bool lightsStay = false; // virtual ones, where they are
  vec3 lampIntensity{1};   // W/sr, of all lamps
  std::string offer = {};  // what using would do now
  Gait gait = Gait::Walk;  // shown
  float speed = 1;         // of the player, times the usual
  Pacer pacer{{}, false};  // of frames, by the image's scale
  std::optional<GoalShown> goal = {};
};

/// A small window over the image, as long as this lives, that takes no input. Its point `pivot` (0 to 1 of its own
/// size) stands at `at`.
class Overlay {
 public:
  Overlay(const char* id, const ImVec2& at, const ImVec2& pivot);
  ~Overlay();
  Overlay(const Overlay&) = delete;
};

/// What was pressed in the menu.
struct MenuChoice {
  bool resume = false, restart = false, home = false, quit = false;
  std::string scene = {}; // to be opened
};

/// Draws, behind the panel: which virtual light is at the crosshair; the link to its mailbox, the point from which it
/// is known to be seen; the points of its cell, the surface that it stands for; its light paths; and what its shadow
/// map shows. `scale`: of the display's pixels.
void drawVplAtCrosshair(const Viewer& gi, const CameraView& camera, float scale);

class Hud {
 public:
  explicit Hud(GLFWwindow* window);
  ~Hud();
  Hud(const Hud&) = delete;

  /// Says whether a text field or a slider uses the keys or the mouse at the moment.
  bool keysTaken() const;
  bool mouseTaken() const;

  /// Shows one line at the bottom for some seconds.
  void say(std::string message);
  const std::string& lastSaid() const { return lastSaid_; }
  float scale() const { return scale_; } // of letters, by the display's pixels per inch

  // Between these two, what is to be drawn into the framebuffer that is bound at the end.
  void begin();
  void end();
  /// Draws over the image of the last Viewer::run.
  void draw(HudModel& model, Scene& scene, Viewer& gi, TruthView& truth, const FrameStats& stats,
            const FrameTimes& times);
  void drawProgress(const std::string& scene, const std::string& at, float share);
  /// `playing`: there is a scene to go back to.
  MenuChoice drawMenu(const std::vector<std::string>& scenes, bool playing);

  /// Keeps the window's next frame as it is so far, to stand behind drawProgress.
  void keepFrame();
  void forgetFrame();

 private:
  void drawPanel(HudModel& model, Scene& scene, Viewer& gi, TruthView& truth, const FrameStats& stats);
  void drawQuality(HudModel& model, Viewer& gi);
  void drawStages(const FrameStats& stats);
  void drawMemory();
  void drawEffects(Settings& settings, const FrameStats& stats);
  void drawFigures(const FrameStats& stats);
  void drawSettings(Settings& settings);
  void drawSetting(Settings& settings, const struct SettingRow& row);
  void change(Settings& settings, const std::function<void(Settings&)>& edit);
  void drawSpeed(const HudModel& model, const FrameTimes& times);
  void drawGoal(const GoalShown& goal) const;
  void drawOffer(const HudModel& model) const;
  void drawHelp() const;
  void drawMessages();

  struct Message {
    std::string text;
    double until = 0; // seconds of the ImGui clock
  };
  std::deque<Message> messages_;
  std::optional<bool> wasFolded_; // the panel
  std::string lastSaid_;
  std::unique_ptr<gl::Texture> keptFrame_;
  float scale_ = 1;                                          // of the display's pixels
  std::map<uint16_t, std::pair<double, double>> smoothedMs_; // CPU and GPU by stage
  std::map<std::string, std::string> edited_;                // settings in the middle of being typed
  std::string settingError_, filter_;
};

} // namespace lambent
