// The measuring engine: variants of the settings run over the same views, frame by frame in turn, and what each did and
// showed comes back. What it is held to is another variant (path tracing at watched points, every light at every pixel)
// or a picture of gi/reference; errors are those of gi/measure. Commands choose variants and print.
//
//   Variant → Runner (runners.cpp) → measure (measure.cpp) → Measured
#pragma once

#include "gi/measure/statistics.h"
#include "gi/measure/watched.h"
#include "gi/viewer/viewer.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lambent {

/// Runs one variant, with all that this keeps between frames.
class Runner {
 public:
  virtual ~Runner() = default;
  virtual const FrameStats& run(const SceneView& view) = 0;
  /// The last frame. Runners that draw no pictures give none.
  virtual Image image(Buffer) const { return {}; }
  virtual float exposure() const { return 1; }
  /// Radiance at points (u, v) of the last frame: of indirect light, or of direct (watchesDirect).
  virtual std::vector<TrackedValue> at(std::span<const vec2> points) const = 0;
};

struct Variant;
using MakeRunner = std::function<std::unique_ptr<Runner>(const Variant&)>;

/// Whole frames by Viewer, in the current GL context; values at points are those of the indirect or the direct buffer.
/// Passes are finished one by one unless the settings choose a timing: timer queries that lag would give one variant's
/// times to another.
std::unique_ptr<Runner> wholeFrames(const Variant& variant);
/// The watched points alone, each from all virtual lights by rays; of stages only the placing of these. No GL.
MakeRunner raysAtPoints(const WatchedScene& watched);
/// Truth: the watched points path traced, with so many samples each; where nothing changed since the frame before, its
/// values stay.
MakeRunner pathsAtPoints(const WatchedScene& watched, uint32_t samples, bool clamped = false);

/// One of the things that are measured against each other.
struct Variant {
  std::string name;
  Settings settings;
  uint32_t seed = 1;
  MakeRunner make = wholeFrames;
};

struct RunPlan {
  std::function<SceneView(int)> view; // of a frame; valid until the next call
  int frames = 1;
  int skip = 0;       // frames at the start that do not count
  bool inTurn = true; // false: one variant after the other, so that one alone takes memory: for still views
  std::optional<Buffer> buffer = {}; // to be read after the last frame
  std::vector<int> also = {};        // ascending: frames before the last after which it is read too
  std::span<const vec2> points = {}; // to be read after every frame, also those that do not count
  std::function<bool()> cancelled = {};
  std::function<void(int, int)> progress = {}; // frames done, frames of all variants
};

struct Measured {
  Variant variant;
  std::vector<FrameStats> frames = {}; // those that count
  Image image = {};
  std::vector<Image> before = {}; // those of RunPlan::also
  uint64_t gpuBytes = 0;          // that GL objects held after the last frame; of all variants where they run in turn
  float exposure = 1;
  std::vector<std::vector<TrackedValue>> series = {}; // [frame][point], all frames

  /// Of a value over the frames that count.
  Spread of(const std::function<double(const FrameStats&)>& value) const;
  /// Milliseconds of a stage, the longer of CPU and GPU, over the frames in which it ran.
  Spread ms(StageId stage) const;
  /// Stages that ran, in the order in which they did so first.
  std::vector<StageId> stages() const;
};

/// In turn, who begins a frame is second in the next, so that none has the caches to itself. Throws RunError when
/// cancelled, after the frame that is running.
std::vector<Measured> measure(const std::vector<Variant>& variants, const RunPlan& plan);

/// The first thing that does not hold; empty: light is finite and not negative at every pixel, albedo in [0, 1],
/// normals and depths finite. Indirect light by itself is an estimate with differences that rays add
/// (gi/gather/map_checks.h), and may be less than nothing. Virtual lights are no more than there
/// may be, and each that is alive has a place, a unit normal, and finite radiance and area that are not negative.
std::string defectOf(const Viewer& gi, const Settings& settings);

} // namespace lambent
