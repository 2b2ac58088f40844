// From keys, mouse and gamepad to wishes.
#pragma once

#include "game/rules/pad.h"
#include "game/rules/player.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

struct GLFWwindow;

namespace lambent {

/// What the person asked for since the last frame.
struct Wishes {
  MoveInput move;
  bool menu = false, help = false, panel = false;
  bool gait = false, home = false, restart = false;
  bool use = false, hurl = false;                // what is looked at, or carried
  bool lamp = false, box = false, torch = false; // into the hand; the torch is worn
  bool pause = false, followPath = false, record = false, dayRuns = false;
  bool screenshot = false, reloadShaders = false;
  bool truth = false;             // the next way to look at it
  float divider = 0;              // -1 to the left, 1 to the right
  std::optional<float> dividerAt; // where the mouse draws it, share of the window's width
  int exposure = 0;               // steps of a third of an EV
  std::optional<int> buffer;      // debug view by its number key: 0 for the first
};

/// Key and meaning, for the help text; an empty meaning is a heading.
std::vector<std::pair<const char*, const char*>> keyHelp();

class Input {
 public:
  explicit Input(GLFWwindow* window);

  /// `keysTaken`, `mouseTaken`: the panel uses them at the moment. `mayCapture`: a click into the image catches the
  /// pointer. `seconds` since the last call.
  Wishes read(bool keysTaken, bool mouseTaken, bool mayCapture, float seconds);
  /// Reads only whether Escape went down, while nothing can be played.
  bool escape();

  /// For tests, keys that go down and up by themselves: "R@1 W@2-40", by calls of read, the first being 1.
  void script(const std::string& presses);

  bool captured() const { return captured_; }
  void release();

 private:
  struct Press {
    int key, from, to;
  };
  bool down(int key) const;
  bool tapped(int key); // went down since the last call
  bool clicked(int button);
  void readKeys(Wishes& w);
  void readMouse(Wishes& w, bool mouseTaken, bool mayCapture);
  void readPad(Wishes& w, float seconds);
  void capture();

  GLFWwindow* window_;
  std::vector<Press> presses_;
  int frame_ = 0;
  std::map<int, bool> down_, buttons_;
  PadButtons padBefore_{};
  bool looking_ = false, captured_ = false;
  double cursorX_ = 0, cursorY_ = 0;
};

} // namespace lambent
