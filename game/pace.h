// Holds the walkthrough's frames at a target (gi/plan/governor.h), and shows what stands still at full scale.
#pragma once

#include "gi/contract/figures.h"
#include "gi/plan/governor.h"

#include <optional>

namespace lambent {

class Pacer {
 public:
  /// Without a target, frames are held at kUsable where they would take longer.
  Pacer(std::optional<double> targetMs, bool choosesPreset);

  /// Chooses scale and preset to begin with, where a frame at full scale and with these settings is expected to take so
  /// long.
  void expect(double fullMs, Settings& settings);

  /// Scale of the next frame. Where nothing has moved for a while, as large as can be drawn in half a second, so that
  /// whoever moves again need not wait; in the end 1.
  float scale() const { return moving() ? governed_.scale : stillFrames_ < 2 * kStillFrames ? halfway_ : 1.0f; }
  /// Notes after a frame what it took, at least `wholeMs` from its beginning to the next one's, and whether anything
  /// had moved for it. `settings` may get another preset.
  void took(const FrameStats& stats, double wholeMs, bool moved, Settings& settings);

  /// Sets the scale by hand; nothing else changes it until `govern`.
  void hold(float scale);
  void govern(double targetMs);

  bool governs() const { return governs_; }
  double targetMs() const { return targetMs_; }
  const std::string& preset() const { return governed_.preset; } // chosen; empty: none
  std::string text() const;                                      // what it does, one line

 private:
  static constexpr double kUsable = 90; // ms: ten frames in a second, with something to spare
  static constexpr double kHalfwayMs = 500;
  static constexpr int kStillFrames = 10;
  bool moving() const { return !governs_ || stillFrames_ < kStillFrames; }

  Governed governed_;
  double targetMs_;
  bool governs_ = true;
  int stillFrames_ = 0;
  float halfway_ = 1; // scale that takes kHalfwayMs
};

} // namespace lambent
