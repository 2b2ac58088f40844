// A scene on its way from disk, on a thread of its own, while the window goes on.
#pragma once

#include "game/rules/goal.h"
#include "game/rules/props.h"
#include "game/rules/solids.h"
#include "tools/launch/launch.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace lambent {

/// A scene with all that needs no OpenGL.
struct LoadedScene {
  std::unique_ptr<LaunchContext> stage;
  std::unique_ptr<Solids> solids;
  std::unique_ptr<Goal> goal; // null: the scene has none
};

/// How far something long is.
struct Progressed {
  std::string at;
  float share = 0;
};

/// Thrown out of long work where the person no longer wants it.
struct Cancelled {};

/// The longest time between two signs of life, and what was done meanwhile.
class LongestGap {
 public:
  /// Notes that the work is at `what` now (at) or over (end).
  void at(const std::string& what);
  void end();
  void add(const LongestGap& other);
  double ms() const { return ms_; }
  const std::string& where() const { return where_; }
  const std::string& now() const { return now_; }

 private:
  std::optional<std::chrono::steady_clock::time_point> last_;
  std::string now_, where_;
  double ms_ = 0;
};

class Loading {
 public:
  explicit Loading(const LaunchOptions& options);
  /// Cancels, and waits until the thread has noticed.
  ~Loading();
  Loading(const Loading&) = delete;

  bool done() const { return done_; }
  Progressed progress() const;
  LongestGap gap() const;
  /// Takes the scene once it is loaded. Throws what ended the loading: InputError, RunError.
  LoadedScene take();
  /// Makes the thread end at its next step: a mesh or a texture.
  void cancel() { cancelled_ = true; }
  const std::string& file() const { return options_.scene; }

 private:
  void load();
  void tell(const char* at, float share);

  const LaunchOptions options_;
  std::atomic<bool> cancelled_ = false, done_ = false;
  mutable std::mutex mutex_;
  Progressed progress_;
  LongestGap gap_;
  LoadedScene loaded_;
  std::exception_ptr failure_;
  std::thread thread_; // last: it uses the rest
};

} // namespace lambent
