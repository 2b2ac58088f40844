// Plots of errors against thresholds, of values over time and of cost over amounts, as SVG.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lambent {

struct PlotSeries {
  std::string name;
  std::vector<double> y; // beside Plot::x; NaN is left out
  const char* colour = nullptr;
};

/// x runs logarithmically, where a first value of 0 stands half a decade before the next, beyond a gap in the axis; or
/// evenly.
struct Plot {
  std::string title, xLabel, yLabel;
  std::vector<double> x;             // ascending, not negative
  std::optional<size_t> marked = {}; // gets rings and a line, and the others dots: the value in use
  bool even = false;
  bool logarithmic = false; // y too, from the decade of the least value above 0; else from 0
  std::vector<PlotSeries> series;
};

/// So many side by side.
std::string svgOf(const std::vector<Plot>& plots, size_t perRow = 4);

} // namespace lambent
