// The panel over the picture: what is shown, where the time goes, and every setting.
#pragma once

#include "game/pace.h"
#include "game/truth_view.h"
#include "gi/frame/gi_frame.h"

#include <deque>
#include <map>
#include <string>

struct GLFWwindow;

namespace lambent {

/// What panel and keys change and the main loop obeys.
struct HudModel {
  Buffer buffer = Buffer::Beauty;
  std::string preset = {}; // the last one chosen, empty: none; single settings may differ from it
  bool panel = true, help = false;

  double time = 0, duration = 1; // seconds of the scene; the slider's length
  bool paused = false;
  bool hasPath = false, followPath = false; // camera path of a shot

  bool lamp = false;
  vec3 lampIntensity{1};  // W/sr
  float speed = 1;        // of the player, m/s
  Pacer pacer{{}, false}; // of frames, by the picture's scale
};

class Hud {
 public:
  explicit Hud(GLFWwindow* window);
  ~Hud();
  Hud(const Hud&) = delete;

  /// Whether a text field or a slider uses the keys or the mouse at the moment.
  bool keysTaken() const;
  bool mouseTaken() const;

  /// One line at the bottom, for some seconds.
  void say(std::string message);
  /// Draws into the framebuffer that is bound, over the picture of the last GiFrame::run.
  void draw(HudModel& model, GiFrame& gi, TruthView& truth, const FrameStats& stats);

 private:
  void drawPanel(HudModel& model, GiFrame& gi, TruthView& truth, const FrameStats& stats);
  void drawPace(Pacer& pacer);
  void drawStages(const FrameStats& stats);
  void drawEffects(Settings& settings, const FrameStats& stats);
  void drawSettings(Settings& settings);
  void change(Settings& settings, const std::function<void(Settings&)>& edit);
  void drawHelp() const;
  void drawMessages();

  struct Message {
    std::string text;
    double until = 0; // seconds of the ImGui clock
  };
  std::deque<Message> messages_;
  std::map<uint16_t, std::pair<double, double>> smoothedMs_; // CPU and GPU by stage
  double smoothedFrameMs_ = 0;
  std::map<std::string, std::string> edited_; // settings in the middle of being typed
  std::string settingError_;
};

} // namespace lambent
