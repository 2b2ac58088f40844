// What the forms of `lambent accuracy` share; figures of papers 2 and 3 of light from reflective shadow maps, as data.
#pragma once

#include "gi/measure/runs/sweeps.h"
#include "tools/lambent/study.h"

namespace lambent {

struct AccuracyOptions : MeasureOptions {
  int slots = 64, points = 1024;
  std::string curve, figure; // empty: none
  bool alone = false, joint = false;
  void (*form)(const AccuracyOptions&) = nullptr; // null: shadow maps of virtual lights

  SweepPart sweepPart() const { return quick ? SweepPart::Quick : joint ? SweepPart::Joint : SweepPart::All; }
};

/// A setting and its values, ascending.
struct FigureAxis {
  std::string setting = {}; // empty: none
  std::vector<std::string> values = {""};
};

/// A picture that is kept. Of indirect light: measured too.
struct FigurePicture {
  const char* name;
  Assignments set;
  const char* technique = nullptr; // null: each of the figure's
  Buffer buffer = Buffer::Indirect;
};

/// What errors are measured against: nothing, the same VPLs at every pixel, or every texel of the maps at every pixel.
enum class FigureTruth { None, Pixels, Texels };

/// What is plotted over PaperFigure::x, a line for each value of PaperFigure::series.
struct FigureCurve {
  const char *key, *label;
  double factor = 1;
};
inline constexpr FigureCurve kRate{"fps", "frames per second"}, kPatches{"patches", "patches, thousands", 1e-3},
    kError{"rmse_share", "RMSE, % of mean indirect radiance", 100}, kLights{"vpls", "VPLs"};

struct PaperFigure {
  const char *name, *title;
  std::vector<std::string> techniques;
  FigureAxis x = {}, series = {}; // each technique with each value of both
  std::vector<FigurePicture> pictures = {};
  FigureTruth truth = FigureTruth::Pixels;
  std::vector<FigureCurve> curves = {kRate};
  bool overTime = false; // of the shot, and its frames are the rows
};
const std::vector<PaperFigure>& paperFigures();

/// What accuracy costs in time: all knobs and techniques, in several scenes, on one page.
void accuracyReport(const AccuracyOptions& options);
/// Error against threshold: "patches" of the picture (paper 3, fig. 9) or "clusters" of the lights (fig. 13).
void accuracyCurve(const AccuracyOptions& options);
/// Figures of papers 2 and 3, as --figure takes them: "2.7"; table, plot and pictures go into the folder.
std::vector<std::string> reflectiveFigureNames();
void reflectiveFigure(const AccuracyOptions& options);

} // namespace lambent
