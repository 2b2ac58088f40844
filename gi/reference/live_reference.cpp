#include "gi/reference/live_reference.h"

#include "engine/trace/embree_query.h"

#include <algorithm>
#include <chrono>

namespace lambent {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPassMs = 400;          // of tracing, until the next image
constexpr uint32_t kMostSamples = 65536; // of each pixel; then it rests

/// Why samples of another view are good for nothing; empty where they are.
std::string whatChanged(const SceneChanges& changes) {
  if (changes.first) return "another scene";
  if (changes.camera) return "the camera changed"; // its image's size, too
  if (changes.lights) return "the light changed";
  if (changes.geometry || changes.instances) return "objects moved";
  return {};
}

} // namespace

/// What the thread works on: its own rays, lights and sums.
class LiveReference::Tracing {
 public:
  Tracing(uint32_t seed, const std::atomic<bool>& stopped) : seed_(seed), stopped_(stopped) {}

  void begin(std::unique_ptr<Task> task) {
    task_ = std::move(task);
    const SceneView& view = task_->view.view();
    const std::pair given(view.assets->identity.value(), view.assets->meshRevision);
    if (given != opened_) {
      rays_ = std::make_unique<EmbreeQuery>(*view.assets);
      opened_ = given;
    }
    rays_->update(view, true); // views in between may not have come here
    lights_ = collectLights(view);
    sums_ = ReferenceSums(view.camera.width, view.camera.height);
    ms_ = 0;
  }

  /// Takes more samples. The first image comes soon; passes double until they take their time.
  void pass() {
    const uint32_t affordable = ms_ > 0 ? uint32_t(std::min(kPassMs * sums_.samples / ms_, double(kMostSamples))) : 1;
    const uint32_t count =
        std::min(std::clamp(affordable, 1u, std::max(1u, sums_.samples)), kMostSamples - sums_.samples);
    const auto begin = Clock::now();
    RayCounts counts;
    if (count > 0) addSamples(sums_, inputs(), count, counts);
    ms_ += std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  }

  std::shared_ptr<const LiveTruth> read(ReferenceBuffer buffer) const {
    return std::make_shared<LiveTruth>(LiveTruth{.buffer = buffer,
                                                 .image = readReference(sums_, inputs(), buffer),
                                                 .samples = sums_.samples,
                                                 .bounces = task_->paths.bounces,
                                                 .ms = ms_});
  }

  bool complete() const { return sums_.samples >= kMostSamples; }

 private:
  ReferenceInputs inputs() const {
    const SceneView& view = task_->view.view();
    return {.rays = *rays_,
            .lights = lights_,
            .camera = view.camera,
            .bounces = task_->paths.bounces,
            .seed = seed_,
            .glossy = task_->paths.glossy ? &view : nullptr,
            .normalMaps = task_->paths.normalMaps ? &view : nullptr,
            .blended = view.assets->blends() ? &view : nullptr,
            .mixes = task_->paths.mixes,
            .stopped = &stopped_};
  }

  const uint32_t seed_;
  const std::atomic<bool>& stopped_;
  std::unique_ptr<Task> task_;
  std::pair<uint64_t, uint64_t> opened_; // identity and revision of its meshes
  std::unique_ptr<EmbreeQuery> rays_;
  LightSet lights_;
  ReferenceSums sums_;
  double ms_ = 0;
};

LiveReference::LiveReference(uint32_t seed) : seed_(seed), thread_([this] { work(); }) {}

LiveReference::~LiveReference() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = stopped_ = true;
  }
  asked_.notify_one();
  thread_.join();
}

std::string LiveReference::follow(const SceneView& view, const Settings& settings, ReferenceBuffer buffer) {
  const Paths paths{settings.smc.bounces, tracesGlossy(view, settings, buffer), tracesNormalMaps(view, settings),
                    mixesBlended(view, buffer)};
  std::string why = followed_ ? whatChanged(view.changes) : "it begins";
  if (why.empty() && followed_->bounces != paths.bounces) why = "smc.bounces changed";
  if (why.empty() && *followed_ != paths) why = "surfaces reflect in another way";
  followed_ = paths;
  const bool begins = why.empty() && waiting_;
  waiting_ = !why.empty();
  {
    const std::lock_guard lock(mutex_);
    if (why.empty() && !begins && buffer == buffer_) return why;
    buffer_ = buffer;
    ready_ = nullptr;
    if (begins || waiting_) {
      stopped_ = true;
      task_ = begins ? std::make_unique<Task>(Task{ViewCopy(view), paths}) : nullptr;
    }
    done_ = waiting_;
  }
  asked_.notify_one();
  return why;
}

std::shared_ptr<const LiveTruth> LiveReference::take(bool wait) {
  std::unique_lock lock(mutex_);
  if (wait) answered_.wait(lock, [&] { return ready_ || done_ || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  return std::move(ready_);
}

void LiveReference::work() {
  Tracing tracing(seed_, stopped_);
  std::unique_lock lock(mutex_);
  for (;;) {
    asked_.wait(lock, [&] { return quit_ || !done_; });
    if (quit_) return;
    std::unique_ptr<Task> task = std::move(task_);
    if (task) stopped_ = false;
    const ReferenceBuffer buffer = buffer_;
    lock.unlock();
    std::shared_ptr<const LiveTruth> truth;
    std::exception_ptr failure;
    try {
      if (task) tracing.begin(std::move(task));
      tracing.pass();
      if (!stopped_) truth = tracing.read(buffer);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (truth && !stopped_ && buffer == buffer_) {
      ready_ = std::move(truth);
      done_ = tracing.complete();
    }
    failure_ = failure;
    if (ready_ || failure_) answered_.notify_all();
    if (failure_) return;
  }
}

} // namespace lambent
