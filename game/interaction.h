// From keys and mouse to wishes, and the recorder of camera paths.
#pragma once

#include "engine/scene/shot.h"
#include "game/player.h"

#include <map>
#include <optional>
#include <string>

struct GLFWwindow;

namespace lambent {

/// What the person asked for since the last frame.
struct Wishes {
  MoveInput move;
  bool quit = false, pause = false, help = false, panel = false, followPath = false;
  bool lamp = false, recordKey = false, screenshot = false, reloadShaders = false;
  bool truth = false;             // the next way to look at it
  float divider = 0;              // -1 to the left, 1 to the right
  std::optional<float> dividerAt; // where the mouse draws it, share of the window's width
};

/// Key and meaning, for the help text.
std::vector<std::pair<const char*, const char*>> keyHelp();

class Interaction {
 public:
  explicit Interaction(GLFWwindow* window);

  /// `keysTaken`, `mouseTaken`: the panel uses them at the moment.
  Wishes read(bool keysTaken, bool mouseTaken);

 private:
  bool tapped(int key); // went down since the last call

  GLFWwindow* window_;
  std::map<int, bool> down_;
  bool looking_ = false;
  double cursorX_ = 0, cursorY_ = 0;
};

/// Collects camera keys, two seconds apart, and keeps the file up to date after each of them.
class ShotRecorder {
 public:
  explicit ShotRecorder(std::filesystem::path scene) : scene_(std::move(scene)) {}

  /// Adds where the player is and writes the shot. Returns what to tell the person. Throws RunError.
  std::string addKey(const Player& player, const dvec3& origin);

 private:
  std::filesystem::path scene_;
  Shot shot_;
};

} // namespace lambent
