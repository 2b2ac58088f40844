// Plots of errors against thresholds, as SVG.
#pragma once

#include <string>
#include <vector>

namespace lambent {

struct PlotSeries {
  std::string name;
  std::vector<double> y; // beside Plot::x
};

/// x runs logarithmically; a first value of 0 stands half a decade before the next, beyond a gap in the axis.
struct Plot {
  std::string title, xLabel, yLabel;
  std::vector<double> x; // ascending, not negative
  size_t marked = 0;     // gets rings and a line: the value in use
  std::vector<PlotSeries> series;
};

/// Side by side, y from 0.
std::string svgOf(const std::vector<Plot>& plots);

} // namespace lambent
