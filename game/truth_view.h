// The path-traced truth next to the image: traced in the background while the view is on, shown in one half of the
// window or as the image's error, with the figures that go with it.
#pragma once

#include "gi/measure/image_error.h"
#include "gi/reference/live_reference.h"
#include "gi/viewer/viewer.h"

namespace lambent {

enum class TruthMode { Off, Split, Heat };

/// Returns the reference buffer of what a buffer shows, which has its number; none for those that are no light.
std::optional<ReferenceBuffer> referenceOf(Buffer buffer);

/// Frames that were drawn (a settled one stays) since anything about the view or its light last changed.
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

  /// Must be called after every frame, on or off. Reads the image back where a new truth has come. With `wait`
  /// every frame waits for one: tests then see as many passes as frames. Throws what ended the tracing.
  void update(const SceneView& view, Viewer& gi, const FrameStats& stats, Buffer shown, bool wait);
  /// Draws the image into the window, as the mode asks.
  void present(const Viewer& gi, Buffer shown, int width, int height) const;

  // Of what is shown. Null until a truth has come.
  const LiveTruth* truth() const { return truth_.get(); }
  const AgainstTruth& against() const { return against_; }
  const FramesSpent& spent() const { return spent_; }
  /// Returns the full error as chosen, or a round number of at least twice the RMSE.
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
/// Draws over the image what is where and what colours mean.
void drawTruthLegend(const TruthView& truth, Buffer shown);

} // namespace lambent
