// Points of gi/measure/runs/sweeps.h measured in one scene: each moves along a shot and then stands where this ends,
// compared with path tracing. What is measured is kept, run by run, so that a long sweep can be interrupted and goes
// on.
#pragma once

#include "gi/measure/front.h"
#include "tools/lambent/accuracy.h"

#include <map>

namespace lambent {

/// Frames of a run. What is slow (SweepPoint::slow) joins for the last frames in motion, and does not stand.
struct SweepFrames {
  int moving = 12, slow = 3, still = 24;
};

/// What is known of one scene: its runs, their truth, and the conditions.
struct SweptScene {
  std::string name;
  Value runs = Value::list();       // see sweep.cpp
  Value truth;                      // by light: paths per pixel, its error, time of path tracing
  Image truths[2];                  // irradiance of indirect light, of direct light
  float exposure = 1;               // of irradiance, for show
  std::filesystem::path pictures;   // folder of RUN.exr, the indirect irradiance of standing runs
  std::vector<std::string> leftOut; // points that do not go with the scene, and why
};

/// Measures what is not yet in `folder`. The default is measured again and again between the others: the machine's own
/// changes of pace are taken out of every time. Throws RunError when interrupted; the same call goes
/// on.
SweptScene sweepScene(const AccuracyOptions& options, const std::string& file, const std::filesystem::path& folder,
                      const SweepFrames& frames);

/// A point in one scene, means over its seeds; over all scenes, geometric means of what it is of the default.
struct PointFigures {
  SweepPoint point;
  CostError moving;         // ms of a frame, relMSE of the last one in motion
  CostError still;          // the same standing; costs 0 where that was not measured
  Value row;                // of one scene: all figures, for tables; see kPointColumns
  std::string picture = {}; // file in SweptScene::pictures; of the first seed
};
using Figures = std::map<std::string, PointFigures>; // by name

/// Times are brought to one pace by the controls beside them. Noise of errors is the relative spread over seeds, pooled
/// over all points that have several, of times that of the controls beside them, each over the root of the runs.
Figures figuresOf(const SweptScene& scene);
/// Of the points that all scenes have.
Figures overScenes(const std::vector<Figures>& scenes);

/// Which of the points these are: CostErrors beside names, for the functions of gi/measure/front.h.
struct Choice {
  std::vector<std::string> names;
  std::vector<CostError> points;
};
/// Those that `take` gives a cost above 0 for.
Choice choiceOf(const Figures& figures, const std::function<CostError(const PointFigures&)>& take);

/// The points that presets are chosen among: the default and the joint sweep.
Choice presetChoice(const Figures& overScenes);

/// Columns of PointFigures::row.
extern const std::vector<TableColumn> kPointColumns;

} // namespace lambent
