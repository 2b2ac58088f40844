// What `lambent stability` writes: tables in Markdown and CSV, series in CSV, plots.
#pragma once

#include "engine/core/image.h"
#include "gi/measure/ranking.h"
#include "gi/measure/stability.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace lambent {

/// |E| and |E'| of each seed, and against halves of the truth: what rankings are made from.
struct ErrorRuns {
  StatisticRuns error, change;
};

/// One technique over one shot.
struct TechniqueRun {
  std::string name;
  uint32_t vpls = 0; // N; those of most in a frame where it varies; 0: every pixel has its own clusters
  PixelSeries series;
  StabilityErrors marked, grid; // means over the seeds
  ErrorRuns runsMarked, runsGrid;
  StabilityErrors stillMarked, stillGrid; // of the same view standing still, where ShotRun::still is set
  Latency latency;
  double placeMs = 0; // median time per frame of placing virtual lights
};

/// One shot. The first `marked` pixels are the shot's own, the others its grid.
struct ShotRun {
  std::string name;
  double fps = 30;
  size_t marked = 0;
  PixelSeries truth;
  std::vector<size_t> steps; // frames in which the scene changes by a step
  bool still = false;        // also measured standing still
  double truthError = 0;     // standard error of a value of the truth, RMS, tone-mapped luminance
  Image picture; // values of the display: the first frame, with the marked pixels numbered; empty: none are marked
  std::vector<TechniqueRun> techniques;

  const TechniqueRun* technique(const std::string& name) const;
};

/// A row for each technique of each shot, for programs and for the tables.
nlohmann::json stabilityFigures(const std::vector<ShotRun>& shots);
/// The rows as Markdown.
std::string stabilityTable(const nlohmann::json& figures);
/// A line for each shot and error: who is better than whom, as far as noise lets one tell. Empty of one technique.
std::string stabilityRankings(const std::vector<ShotRun>& shots);
/// stability.csv, stability.md and of each shot series-SHOT.csv and of its marked pixels a picture and plots, each in
/// one step.
void writeStabilityReport(const std::filesystem::path& folder, const std::vector<ShotRun>& shots,
                          const nlohmann::json& figures, const std::string& conditions);

} // namespace lambent
