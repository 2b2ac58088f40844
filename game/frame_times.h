// How fast frames follow one another, and what they spend their time on: for the corner of the window.
#pragma once

#include "gi/contract/figures.h"

#include <deque>

namespace lambent {

class FrameTimes {
 public:
  /// Adds a frame that came `seconds` after the one before.
  void add(double seconds, const FrameStats& stats);

  struct Frame {
    double wholeMs = 0; // from frame to frame
    double cpuMs = 0, gpuMs = 0;
  };
  const std::deque<Frame>& frames() const { return frames_; } // oldest first
  double meanMs() const;                                      // over the last second

 private:
  static constexpr size_t kMost = 240;
  std::deque<Frame> frames_;
};

} // namespace lambent
