// What the forms of `lambent accuracy` share.
#pragma once

#include "gi/measure/runs/sweeps.h"
#include "tools/lambent/commands.h"

#include <optional>
#include <string>
#include <vector>

namespace lambent {

struct AccuracyOptions {
  LaunchOptions launch; // its scene is empty where several are given
  OutputOptions output;
  std::vector<std::string> scenes;
  int slots = 64, points = 1024;
  std::string curve, figure; // empty: none
  int frame = 0;             // of a shot
  bool convergence = false, light = false, direct = false, alone = false, gathers = false, volume = false,
       report = false, joint = false, quick = false;
  std::optional<int> samples, seeds;
  std::optional<double> clamp; // 1/m²

  SweepPart sweepPart() const { return quick ? SweepPart::Quick : joint ? SweepPart::Joint : SweepPart::All; }
};

/// Error against threshold: "patches" of the picture (paper 3, fig. 9) or "clusters" of the lights (fig. 13).
void accuracyCurve(const AccuracyOptions& options);
/// How the set of virtual lights converges (paper 1, 5.4).
void accuracyConvergence(const AccuracyOptions& options);
/// Ways to gather the same virtual lights: time, and error against every light at every pixel.
void accuracyGathers(const AccuracyOptions& options);
/// Bias and error of indirect irradiance against path tracing, as set, and with every light at every pixel by rays.
void accuracyLight(const AccuracyOptions& options);
/// Bias and error of direct light against path tracing, as set, and by other means.
void accuracyDirect(const AccuracyOptions& options);
/// Light propagation volumes by their settings, against path tracing.
void accuracyVolume(const AccuracyOptions& options);
/// What accuracy costs in time: all knobs and techniques, in several scenes, on one page.
void accuracyReport(const AccuracyOptions& options);
/// Figures of the papers for any scene: of paper 1 those here, of papers 2 and 3 those of reflective_figures.h.
std::vector<std::string> figureNames();
void accuracyFigure(const AccuracyOptions& options);

/// Throws InputError where no bound of the geometry term is given.
void needClamp(const AccuracyOptions& options);

/// Still pictures of the stage's first view; what is measured of them is the buffer after the last frame.
RunPlan stillPlan(LaunchContext& stage, Progress& progress, Buffer buffer);

} // namespace lambent
