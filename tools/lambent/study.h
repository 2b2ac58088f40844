// A study of pictures of one view: drawn with changing settings, held to path tracing, reported on. What the tables of
// `lambent accuracy` and the comparisons at equal error of `lambent bench` are made with.
#pragma once

#include "engine/platform/gl_context.h"
#include "gi/measure/against_truth.h"
#include "gi/measure/ranking.h"
#include "gi/reference/traced_picture.h"
#include "tools/lambent/accuracy.h"
#include "tools/lambent/text.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

/// A view that is drawn, traced and reported on.
class Study {
 public:
  /// `defaults` and `size` hold unless the command line says otherwise. `options` must outlive the study.
  Study(const AccuracyOptions& options, const std::string& size, Assignments defaults = {});

  Variant variant(const std::string& name, const Assignments& assignments) const;

  /// The first view, standing still.
  std::vector<Measured> draw(const std::vector<Variant>& variants, Buffer buffer, int frames = 1, int skip = 0,
                             bool inTurn = false);
  /// Of a shot, from its first frame to this one.
  std::vector<Measured> drawUpTo(int frame, const std::vector<Variant>& variants, Buffer buffer);

  /// `state` keeps the sums; empty: nothing does. Throws RunError when interrupted.
  const TracedPicture& trace(int samples, ReferenceBuffer buffer, bool clamped, const std::filesystem::path& state = {},
                             int frame = 0);

  /// The table, with how well its truth is known.
  void report(const std::vector<TableColumn>& columns, const nlohmann::json& rows,
              nlohmann::json figures = nlohmann::json::object()) const;

  LaunchOptions launch;
  std::unique_ptr<LaunchContext> stage;
  std::optional<TracedPicture> truth; // the last one traced

 private:
  const AccuracyOptions& options_;
  std::optional<GlContext> context_;
};

nlohmann::json rowOf(const PictureError& e);
/// Columns of such a row.
inline const TableColumn kRmseShare{"rmse_share", "RMSE over mean", "%.2f %%", 100},
    kRelMse{"rel_mse", "relMSE", "%.4f"}, kBias{"bias", "bias", "%+.1f %%", 100};

/// pathTracingMs by the truth's own variance and pace. May be less than a sample of every pixel takes.
std::optional<double> pathsMs(const TracedPicture& truth, double relMse);
/// Whether path tracing takes kPathTracingTimes a frame or more: "yes", "no", "within noise", "one seed".
const char* holdsBar(const UncertainValue& times);

/// Median over the second half: warm-up and what a first frame makes are past. Not of one frame.
std::optional<double> steadyMs(const std::vector<FrameStats>& frames);

} // namespace lambent
