// frames.csv: what each frame of a recording did and took.
#pragma once

#include "gi/contract/figures.h"
#include "gi/plan/governor.h"

#include <filesystem>

namespace lambent {

/// Keeps the log in memory and writes it whole, so that it is never half-written.
class FrameLog {
 public:
  /// `governed`: of the frame; null: nothing governs.
  void add(double time, const FrameStats& stats, double writeMs, const Governed* governed);

  /// Columns are those of the table of figures, and scene time and time to write a picture. Throws RunError.
  void write(const std::filesystem::path& file) const;

  /// Frames per second over all frames but the first (which warms the set up), pictures on disk included.
  double framesPerSecond() const;

 private:
  struct Row {
    double time = 0;
    FrameStats stats;
    double writeMs = 0;
    float scale = 1;
    std::string preset = {};
  };

  std::vector<Row> rows_;
  bool governed_ = false;
  std::array<bool, kStages> stages_{}; // that ran in any frame
};

} // namespace lambent
