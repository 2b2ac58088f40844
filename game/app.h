// The window from its first frame to its last: choosing a scene, loading it, and playing it.
#pragma once

#include "engine/platform/gl_context.h"
#include "game/hud.h"
#include "game/input.h"
#include "game/loading.h"
#include "game/play.h"

#include <deque>
#include <optional>

namespace lambent {

class App {
 public:
  explicit App(const GameOptions& options);
  ~App();
  App(const App&) = delete;

  /// Runs until the window is closed. Throws what the scene of the command line is refused for.
  void run();

 private:
  void open(const std::string& file, bool given = false);
  void load();   // while a scene is on its way
  void choose(); // while there is none
  void play(double seconds);
  void prepare(LoadedScene loaded);
  bool beginsWithDefaults(const std::string& file, const std::exception& why);
  void obey(const MenuChoice& choice);
  void showProgress(const Progressed& progress);
  void cancelLoading();
  void writeState() const;
  void keepPreferences(double seconds);
  void tellOfCutRecordings();
  void show(); // what was drawn

  GameOptions options_;
  KeptPreferences preferences_;
  GlContext context_;
  Hud hud_;
  Input input_;
  std::unique_ptr<Loading> loading_;
  std::deque<std::unique_ptr<Loading>> cancelled_; // not ended yet
  std::unique_ptr<Play> play_;
  std::vector<std::string> scenes_; // to choose from
  std::deque<std::string> dropped_; // files, onto the window
  bool menu_ = false, preparing_ = false;
  bool given_ = false; // the scene being loaded is the command line's
  int frames_ = 0;
  LongestGap gap_; // of loading and preparing, of the last scene
  std::optional<std::pair<int, int>> windowSize_;
};

} // namespace lambent
