// Holds the walkthrough's frames at a target (gi/plan/governor.h), and shows what stands still at full scale.
#pragma once

#include "gi/contract/figures.h"
#include "gi/plan/governor.h"

#include <optional>

namespace lambent {

class Pacer {
 public:
  /// Without a target the settings stay as they are, and the scale is lowered where frames take longer than kUsable.
  Pacer(std::optional<double> targetMs, bool choosesPreset);

  /// For the next frame. Where nothing has moved for a while: 1.
  float scale() const { return moving() ? governed_.scale : 1.0f; }
  /// After a frame: what it took, and whether anything had moved for it. `settings` may get another preset.
  void took(const FrameStats& stats, bool moved, Settings& settings);

  /// A person sets the scale, and nothing else does until `govern`.
  void hold(float scale);
  void govern(double targetMs);

  bool governs() const { return governs_; }
  double targetMs() const { return targetMs_; }
  const std::string& preset() const { return governed_.preset; } // chosen; empty: none
  std::string text() const;                                      // what it does, one line

 private:
  static constexpr double kUsable = 150; // ms
  static constexpr int kStillFrames = 10;
  bool moving() const { return !governs_ || stillFrames_ < kStillFrames; }

  Governed governed_;
  double targetMs_;
  bool governs_ = true;
  int stillFrames_ = 0;
};

} // namespace lambent
