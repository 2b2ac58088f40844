// What the runs of a sweep amount to: points with cost, error and their noise, scene by scene and over all scenes.
#pragma once

#include "gi/measure/front.h"
#include "tools/lambent/sweep.h"
#include "tools/lambent/text.h"

#include <map>

namespace lambent {

/// A point in one scene, means over its seeds; over all scenes, geometric means of what it is of the default.
struct PointFigures {
  SweepPoint point;
  CostError moving;         // ms of a frame, relMSE of the last one in motion
  CostError still;          // the same standing; costs 0 where that was not measured
  nlohmann::json row;       // of one scene: all figures, for tables; see kPointColumns
  std::string picture = {}; // file in SweptScene::pictures; of the first seed
};
using Figures = std::map<std::string, PointFigures>; // by name

/// Times are brought to one pace by the controls beside them. Noise of errors is the relative spread over seeds, pooled
/// over all points that have several, of times that of the controls beside them, each over the root of the runs.
Figures figuresOf(const SweptScene& scene);
/// Of the points that all scenes have.
Figures overScenes(const std::vector<Figures>& scenes);

/// Both at once: error is the geometric mean of moving and standing, cost that of frames in motion. What presets are
/// chosen by.
CostError bothOf(const PointFigures& point);

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
