// Points of gi/measure/runs/sweeps.h measured in one scene: each moves along a shot and then stands where this ends,
// held to path tracing. What is measured is kept, run by run, so that a long sweep can be interrupted and goes on.
#pragma once

#include "gi/measure/runs/sweeps.h"
#include "tools/lambent/accuracy.h"

#include <filesystem>

namespace lambent {

/// Frames of a run. What is slow (SweepPoint::slow) joins for the last frames in motion, and does not stand.
struct SweepFrames {
  int moving = 12, slow = 3, still = 24;
};

/// What is known of one scene: its runs, their truth, and the conditions.
struct SweptScene {
  std::string name;
  nlohmann::json runs = nlohmann::json::array(); // see sweep.cpp
  nlohmann::json truth;                          // by light: paths per pixel, its error, time of path tracing
  Image truths[2];                               // irradiance of indirect light, of direct light
  float exposure = 1;                            // of irradiance, for show
  std::filesystem::path pictures;                // folder of RUN.exr, the indirect irradiance of standing runs
  std::vector<std::string> leftOut;              // points that do not go with the scene, and why
};

/// Measures what is not yet in `folder`. The default is measured again and again between the others: the machine's own
/// changes of pace are taken out of every time. Throws RunError when interrupted; the same call goes
/// on.
SweptScene sweepScene(const AccuracyOptions& options, const std::string& file, const std::filesystem::path& folder,
                      const SweepFrames& frames);

} // namespace lambent
