// The path-traced truth beside the picture: traced in the background while the view is on, shown in one half of the
// window or as the picture's error, with the figures that go with it.
#pragma once

#include "gi/measure/against_truth.h"
#include "gi/reference/live_reference.h"
#include "gi/viewer/viewer.h"

namespace lambent {

enum class TruthMode { Off, Split, Heat };
constexpr TruthMode nextMode(TruthMode mode) { return TruthMode((int(mode) + 1) % 3); }

/// The truth of what a buffer shows; none of those that are no light.
std::optional<ReferenceBuffer> referenceOf(Buffer buffer);

/// Frames that drew a picture (a settled one stays) since anything about the view or its light last changed.
struct FramesSpent {
  int drawn = 0;
  double ms = 0;                // wall time of all
  std::vector<double> latestMs; // of each of the latest

  double typicalMs() const; // median of the latest; there is one
};

class TruthView {
 public:
  explicit TruthView(uint32_t seed) : seed_(seed) {}

  TruthMode mode() const { return mode_; }
  void set(TruthMode mode);
  void moveDivider(float share) { divider = glm::clamp(divider + share, 0.0f, 1.0f); }

  /// To be told of every frame, on or off, after it ran. Reads the picture back where a new truth has come. With `wait`
  /// every frame waits for one: tests then see as many passes as frames. Throws what ended the tracing.
  void update(const SceneView& view, Viewer& gi, const FrameStats& stats, Buffer shown, bool wait);
  /// Draws the picture into the window, as the mode asks.
  void present(const Viewer& gi, Buffer shown, int width, int height) const;

  // Of what is shown. Null until a truth has come.
  const LiveTruth* truth() const { return truth_.get(); }
  const AgainstTruth& against() const { return against_; }
  const FramesSpent& spent() const { return spent_; }
  /// As chosen, or a round number from twice the RMSE on.
  double fullErrorNow() const;
  /// Why there is no truth yet, in words.
  const std::string& reason() const { return reason_; }

  float divider = 0.5f; // share of the window's width
  float fullError = 0;  // that has the full colour, share of the truth's mean; 0: follows the RMSE

 private:
  void countFrame(const SceneView& view, Settings settings, const FrameStats& stats);

  const uint32_t seed_;
  TruthMode mode_ = TruthMode::Off;
  std::unique_ptr<LiveReference> reference_; // while it is on
  std::shared_ptr<const LiveTruth> truth_;
  AgainstTruth against_;
  FramesSpent spent_;
  Settings before_;
  std::string reason_;
};

/// The figures, side by side, as a part of the panel.
void drawTruthFigures(TruthView& truth);
/// What is where, and what colours mean, over the picture.
void drawTruthLegend(const TruthView& truth, Buffer shown);

} // namespace lambent
