// What the forms of `lambent accuracy` share.
#pragma once

#include "gi/measure/runs/sweeps.h"
#include "tools/lambent/study.h"

namespace lambent {

struct AccuracyOptions : MeasureOptions {
  int slots = 64, points = 1024;
  std::string curve, figure; // empty: none
  bool alone = false, apart = false, joint = false;
  void (*form)(const AccuracyOptions&) = nullptr; // null: shadow maps of virtual lights

  SweepPart sweepPart() const { return quick ? SweepPart::Quick : joint ? SweepPart::Joint : SweepPart::All; }
};

/// Light of one picture, each pixel by itself: without what gives bounded energy back, and without a history.
extern const Assignments kPlain;
/// Throws InputError where no bound of the geometry term is given.
void needClamp(const AccuracyOptions& options);

/// What accuracy costs in time: all knobs and techniques, in several scenes, on one page.
void accuracyReport(const AccuracyOptions& options);
/// Indirect light against path tracing: which part of the squared error is whose (--light --apart).
void accuracyApart(const AccuracyOptions& options, const Study& study);
/// Error against threshold: "patches" of the picture (paper 3, fig. 9) or "clusters" of the lights (fig. 13).
void accuracyCurve(const AccuracyOptions& options);
/// Figures of paper 1, as --figure takes them; tables and pictures go into the folder.
std::vector<std::string> pathFigureNames();
void pathFigure(const AccuracyOptions& options);
/// Figures of papers 2 and 3, as --figure takes them: "2.7"; table, plot and pictures go into the folder.
std::vector<std::string> reflectiveFigureNames();
void reflectiveFigure(const AccuracyOptions& options);

} // namespace lambent
