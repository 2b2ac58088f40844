#include "game/loading.h"

namespace lambent {

namespace {
constexpr float kFile = 0.9f; // share of the time that reading takes; the rest builds what rays need
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
    loaded.stage = loadStage(options_, [this](const char* at, float share) { tell(at, kFile * share); });
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
}

Progressed Loading::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

LoadedScene Loading::take() {
  if (failure_) std::rethrow_exception(failure_);
  return std::move(loaded_);
}

} // namespace lambent
