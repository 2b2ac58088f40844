// What `lambent stability` has measured, and its report.
#pragma once

#include "gi/measure/truth_noise.h"
#include "tools/lambent/report.h"

namespace lambent {

/// Errors of one technique at some of the watched pixels.
struct GroupErrors {
  StabilityErrors mean; // over the seeds
  StatisticRuns error,
      change; // |E| and |E'| of each seed, and against halves of the truth: what rankings are made from
  NoisyErrors noisyError, noisyChange; // the same values with what the truth's noise is; empty of an exact truth
  double still = 0;                    // |E| of the same views standing still, where ShotRun::still is set
};

/// One technique over one shot.
struct TechniqueRun {
  std::string name;
  uint32_t vpls = 0;       // N; those of most in a frame where it varies; 0: every pixel has its own clusters
  PixelSeries series = {}; // of the first seed
  GroupErrors marked = {}, grid = {};
  Latency latency = {}; // the worst of the seeds
  double placeMs = 0;   // median time per frame of placing virtual lights, mean over the seeds
};

/// One shot. The first `marked` pixels are the shot's own, the others its grid.
struct ShotRun {
  std::string name;
  std::string protocol, set; // its name; its settings, as they hold
  double fps = 30;
  size_t marked = 0;
  PixelSeries truth;
  std::vector<size_t> steps; // frames in which the scene changes by a step
  bool still = false;        // also measured standing still
  double truthError = 0;     // standard error of a value of the truth, RMS, tone-mapped luminance
  Image image; // values of the display: the first frame, with the marked pixels numbered; empty: none are marked
  std::vector<TechniqueRun> techniques;
};

/// Before measuring: throws where a file that the report writes for a shot of this name is read, or cannot be written.
void checkStabilityResults(const std::filesystem::path& folder, const std::string& shot);

/// stability.csv, stability.md (tables, rankings) and of each shot series-SHOT.csv and of its marked pixels a picture
/// and plots, each in one step.
void writeStabilityReport(const OutputOptions& output, const std::filesystem::path& folder,
                          const std::vector<ShotRun>& shots, const std::string& conditions);

} // namespace lambent
