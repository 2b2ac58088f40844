// The truth of the view that a window shows, traced while it is shown: a thread of its own takes passes of samples over
// a copy of the view. What changes the view ends them; they start again once it stands still, so whoever walks about is
// not slowed down.
#pragma once

#include "engine/view/view_copy.h"
#include "gi/reference/traced_image.h"

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace lambent {

/// The truth after some passes.
struct LiveTruth {
  ReferenceBuffer buffer = ReferenceBuffer::Beauty;
  ReferenceImage image;
  uint32_t samples = 0; // of each pixel
  int bounces = 0;
  double ms = 0; // of tracing, wall time, with whatever else ran
};

class LiveReference {
 public:
  explicit LiveReference(uint32_t seed = 1);
  ~LiveReference(); // gives up the pass that runs, and joins
  LiveReference(const LiveReference&) = delete;

  /// Must be called for every frame: view.changes counts since the last one. Returns why the samples are of no use any
  /// more, in words; the next view without changes starts again. Empty where they stay, as when another buffer is
  /// wanted that can be read from them. The view's assets must outlive this.
  std::string follow(const SceneView& view, const Settings& settings, ReferenceBuffer buffer);

  /// Returns the newest truth of what was last followed, once; null where none is new. With `wait` it waits for one,
  /// unless none is being traced. Rethrows what ended the thread.
  std::shared_ptr<const LiveTruth> take(bool wait = false);

 private:
  /// What samples depend on, apart from the view.
  struct Paths {
    int bounces = 0;
    bool glossy = false, normalMaps = false, mixes = false;
    bool operator==(const Paths&) const = default;
  };
  struct Task {
    ViewCopy view;
    Paths paths;
  };
  class Tracing;
  void work();

  const uint32_t seed_;
  std::optional<Paths> followed_; // this and the next: of the thread that follows
  bool waiting_ = false;          // for the view to stand still

  std::atomic<bool> stopped_{false}; // the pass that runs is wanted no more
  std::mutex mutex_;                 // guards what follows
  std::condition_variable asked_, answered_;
  bool quit_ = false;
  bool done_ = true;           // until asked again
  std::unique_ptr<Task> task_; // to begin with
  ReferenceBuffer buffer_ = ReferenceBuffer::Beauty;
  std::shared_ptr<const LiveTruth> ready_;
  std::exception_ptr failure_;

  std::thread thread_; // last: it sees all of the above
};

} // namespace lambent
