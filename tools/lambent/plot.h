// Plots as SVG: errors against thresholds, values over time, cost over amounts, error against cost. Lines are told
// apart by colour, marks also in greyscale; every mark is named where the pointer rests on it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

enum class Shape { Dot, Square, Triangle, Diamond };

struct PlotMark {
  double x = 1, y = 1, xNoise = 0, yNoise = 0; // noises are shares, drawn as bars of ± one of them
  std::string name = {};                       // for the pointer
  std::string label = {};                      // next to it
  Shape shape = Shape::Dot;
  bool filled = false;
};
struct PlotLine {
  std::string name = {};               // in its colour at the upper left; empty: a thin dark line, not named
  std::vector<double> x, y;            // NaN is left out
  const char* colour = nullptr;        // null: by its number
  bool dashed = false, stairs = false; // stairs: first right, then down
};
/// Logarithmic axes hold values above 0; but x may begin with 0, which stands half a decade before the next value.
/// Even ones begin at 0 (y) or at the first value (x).
struct Plot {
  std::string title, xLabel, yLabel;
  bool logX = true, logY = false;
  std::vector<PlotLine> lines = {};
  std::vector<PlotMark> marks = {};
  std::vector<std::pair<Shape, std::string>> legend = {}; // at the upper right
  std::optional<double> inUse = {}; // a value of x: gets a line, and rings where the others are dots
  bool ticksAtValues = false;       // of x: at the values of the first line, not at round numbers
};

/// So many side by side; the frame of each has this size in pixels.
std::string svgOf(const std::vector<Plot>& plots, size_t perRow, int width = 420, int height = 240);

} // namespace lambent
