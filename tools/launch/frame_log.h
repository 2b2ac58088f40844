// frames.csv: what each frame of a recording did and took.
#pragma once

#include "engine/core/files.h"
#include "gi/contract/figures.h"
#include "gi/plan/governor.h"

#include <filesystem>
#include <memory>

namespace lambent {

/// Appends a line for each frame, so that whatever ends the program loses none and memory stays. A file that is there
/// stays until the end, in which this takes its place.
class FrameLog {
 public:
  FrameLog() = default;
  FrameLog(FrameLog&&) = default;
  FrameLog& operator=(FrameLog&&) = default;
  ~FrameLog(); // without end(): what was to take a file's place goes

  /// Columns are those of the table of figures, and scene time and time to write a picture.
  void begin(const std::filesystem::path& file);
  /// `governed`: of the frame; null: nothing governs, from the first frame on. Throws RunError.
  void add(double time, const FrameStats& stats, double writeMs, const Governed* governed);
  /// Throws RunError.
  void end();

  /// Frames per second over all frames but the first (which warms the set up), pictures on disk included.
  double framesPerSecond() const;

 private:
  std::filesystem::path file_, written_;
  std::unique_ptr<AppendedFile> out_;
  size_t rows_ = 0;
  double ms_ = 0; // of all but the first
};

} // namespace lambent
