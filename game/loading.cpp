#include "game/loading.h"

namespace lambent {

namespace {
constexpr float kFile = 0.9f; // share of the time that reading takes; the rest builds what rays need
}

void LongestGap::at(const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  const double ms = last_ ? std::chrono::duration<double, std::milli>(now - *last_).count() : 0;
  if (ms > ms_) {
    ms_ = ms;
    where_ = now_;
  }
  last_ = now;
  now_ = what;
}

void LongestGap::end() {
  at("");
  last_.reset();
}

void LongestGap::add(const LongestGap& other) {
  if (other.ms_ <= ms_) return;
  ms_ = other.ms_;
  where_ = other.where_;
}

Loading::Loading(const LaunchOptions& options) : options_(options), thread_([this] { load(); }) {}

Loading::~Loading() {
  cancel();
  thread_.join();
}

void Loading::load() {
  try {
    tell("file", 0);
    LoadedScene loaded;
    loaded.stage = loadLaunch(options_, [this](const char* at, float share) { tell(at, kFile * share); });
    tell("walls and floors", kFile);
    Scene& scene = loaded.stage->scene;
    if (!loaded.stage->props) loaded.stage->props = std::make_unique<Props>(scene);
    loaded.solids = std::make_unique<Solids>(scene);
    loaded.goal = Goal::find(scene);
    tell("done", 1);
    loaded_ = std::move(loaded);
  } catch (...) {
    failure_ = std::current_exception();
  }
  done_ = true;
}

void Loading::tell(const char* at, float share) {
  if (cancelled_) throw Cancelled();
  const std::lock_guard lock(mutex_);
  progress_ = {at, std::max(share, progress_.share)};
  gap_.at(at);
}

Progressed Loading::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

LongestGap Loading::gap() const {
  const std::lock_guard lock(mutex_);
  return gap_;
}

LoadedScene Loading::take() {
  if (failure_) std::rethrow_exception(failure_);
  return std::move(loaded_);
}

} // namespace lambent
