#include "game/frame_times.h"

#include <algorithm>

namespace lambent {

void FrameTimes::add(double seconds, const FrameStats& stats) {
  Frame frame{1000 * seconds, 0, 0};
  for (const StageTime& s : stats.stages) {
    frame.gpuMs += s.gpuMs;
    if (s.gpuMs <= 0) frame.cpuMs += s.cpuMs; // of the others it is the time to ask the GPU, or to wait for it
  }
  frames_.push_back(frame);
  if (frames_.size() > kMost) frames_.pop_front();
}

double FrameTimes::meanMs() const {
  double ms = 0;
  size_t first = frames_.size();
  while (first > 0 && ms < 1000) ms += frames_[--first].wholeMs;
  return first < frames_.size() ? ms / double(frames_.size() - first) : 0;
}

} // namespace lambent
