// What measurements share: variants of the settings run over views of a scene or shot, compared with a truth, and what
// comes out as rows of a table whose columns say where they come from.
#pragma once

#include "engine/platform/gl_context.h"
#include "gi/measure/image_error.h"
#include "gi/measure/statistics.h"
#include "gi/plan/presets.h"
#include "tools/lambent/commands.h"

#include <span>

namespace lambent {

struct MeasureOptions {
  LaunchOptions launch; // its scene is empty where several are given
  OutputOptions output;
  std::vector<std::string> scenes;
  int frame = 0; // of a shot; 0: as the form has it
  std::optional<int> samples, seeds;
  std::optional<double> clamp; // 1/m²
  bool quick = false;
};

/// The settings of what was opened, with a technique (empty: as set) and settings of its own.
Variant variantOf(const LaunchContext& opened, const std::string& name, const Assignments& set = {},
                  const std::string& technique = "");
/// Each with so many seeds, one after the other.
std::vector<Variant> seeded(const std::vector<Variant>& variants, int seeds);
/// Every texel of the reflective maps lights every pixel, without visibility: no choice of VPLs, no cluster, no patch.
/// What techniques from these maps approximate. Their maps are what `rsm.resolution` says. As isr without clusters: the
/// same as hisr's whole tree, two to four times as fast.
void lightByEveryTexel(Settings& settings);
/// How paper 1 compares techniques: maps, 4×4 subsets, a filter, each frame by itself, one clamp, no near light.
Assignments asInPaper1();
/// Lights that are soon placed, unless the command line says otherwise: for --quick.
void useFewLights(MeasureOptions& options);
/// Throws InputError where the technique does not sample its lights.
void needSampledLights(const std::string& technique);

/// The first frames of the shot (0: all; of a scene 60).
RunPlan planOf(LaunchContext& opened, int frames);
/// The first view, standing still; what is measured of it is the buffer after the last frame.
RunPlan stillPlan(LaunchContext& opened, Buffer buffer, int frames = 1, int skip = 0);
/// The views, each watched by the scene before it is run.
std::function<SceneView(int)> watchedBy(WatchedScene& watched, std::function<SceneView(int)> view);

/// measure() with its progress, until Ctrl-C.
std::vector<Measured> run(const std::vector<Variant>& variants, RunPlan plan, const std::string& doing, bool quiet);
/// traceImage() with its progress, until Ctrl-C.
TracedImage trace(const SceneView& view, const Settings& settings, TracePlan plan, const std::string& doing,
                  bool quiet);

/// Median milliseconds of these stages together.
double msOf(const Measured& run, std::initializer_list<StageId> stages);
double msOf(const FrameStats& stats, std::span<const StageId> stages);
double frameMs(const Measured& run);

class Study;

/// What a row is taken from.
struct Outcome {
  const Study& study;
  const Measured& run;
  ImageError error; // against the study's truth, where it has one
};
/// A value of each row.
struct Column {
  TableColumn shown;
  Value (*of)(const Outcome&) = nullptr; // nothing: this row has none; null: what makes the rows sets it
};
inline Value variantName(const Outcome& o) { return o.run.variant.name; }
/// Of errors, which every row has where there is a truth.
inline constexpr Column kRmseShare{{"rmse_share", "RMSE over mean", "%.2f %%", 100}},
    kRelMse{{"rel_mse", "relMSE", "%.4f"}}, kBias{{"bias", "bias", "%+.1f %%", 100}};
std::string tableText(const std::vector<Column>& columns, const Value& rows);

/// One scene or shot that is drawn, traced and reported on.
class Study {
 public:
  /// What holds unless the command line says otherwise.
  struct Defaults {
    std::string size = "", quickSize = "32x18";
    Assignments set = {};
    bool punctual = false; // a sun or lamp where there is none, since reflective maps need one
  };
  /// `options` must outlive the study.
  Study(const MeasureOptions& options, const std::string& scene, const Defaults& defaults);

  Variant variant(const std::string& name, const Assignments& set = {}, const std::string& technique = "") const {
    return variantOf(*opened, name, set, technique);
  }
  /// One variant after the other, the first view standing still.
  std::vector<Measured> draw(const std::vector<Variant>& variants, Buffer buffer, int frames = 1) const;
  /// Of a shot, from its first frame to this one.
  std::vector<Measured> drawUpTo(int frame, const std::vector<Variant>& variants, Buffer buffer) const;

  /// The truth from now on. `state` keeps the sums; empty: nothing does. Throws RunError when interrupted.
  const TracedImage& trace(int samples, ReferenceBuffer buffer, bool clamped = false,
                           const std::filesystem::path& state = {}, int frame = 0);
  const TracedImage& traceView(const SceneView& view, int samples, ReferenceBuffer buffer, bool clamped = false,
                               const std::filesystem::path& state = {});
  /// The truth from now on.
  void compareWith(const Image& picture) { truth = picture; }

  Outcome outcome(const Measured& run) const;
  /// Errors, and what columns hold that say where they come from.
  Value row(const std::vector<Column>& columns, const Measured& run) const;
  Value rows(const std::vector<Column>& columns, std::span<const Measured> runs) const;
  /// The table, with how well its truth is known.
  void report(const std::vector<Column>& columns, const Value& rows, Value figures = Value::of()) const;

  LaunchOptions launch;
  const std::unique_ptr<LaunchContext> opened;
  const GlContext context = GlContext::headless();
  std::optional<TracedImage> traced; // the last one
  Image truth;

 private:
  const MeasureOptions& options_;
};

/// pathTracingMs by the truth's own variance and pace. May be less than a sample of every pixel takes.
std::optional<double> pathsMs(const TracedImage& truth, double relMse);
/// Whether path tracing takes kPathTracingTimes a frame or more: "yes", "no", "within noise", "one seed".
const char* holdsBar(const UncertainValue& times);
/// Median over the second half: warm-up and what a first frame makes are past. Not of one frame.
std::optional<double> steadyMs(const std::vector<FrameStats>& frames);

} // namespace lambent
