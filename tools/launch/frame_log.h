// frames.csv: what each frame of a recording did and took.
#pragma once

#include "gi/contract/figures.h"
#include "gi/plan/governor.h"

#include <filesystem>
#include <fstream>

namespace lambent {

/// Appends a line for each frame, so that whatever ends the program loses none and memory stays.
class FrameLog {
 public:
  /// Columns are those of the table of figures, and scene time and time to write a picture. With the first line an
  /// earlier file goes.
  void begin(const std::filesystem::path& file);
  /// `governed`: of the frame; null: nothing governs, from the first frame on. Throws RunError.
  void add(double time, const FrameStats& stats, double writeMs, const Governed* governed);
  void end() { out_.close(); }

  /// Frames per second over all frames but the first (which warms the set up), pictures on disk included.
  double framesPerSecond() const;

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  size_t rows_ = 0;
  double ms_ = 0; // of all but the first
};

} // namespace lambent
