// Plots of error against cost, both logarithmic, as SVG: readable in greyscale, every point named where the pointer
// rests on it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lambent {

enum class MarkShape { Dot, Square, Triangle, Diamond };

struct Mark {
  double x = 1, y = 1, xNoise = 0, yNoise = 0; // above 0; noises are shares, drawn as bars of ± one of them
  std::string name;                            // for the pointer
  std::string label = {};                      // beside it
  MarkShape shape = MarkShape::Dot;
  bool filled = false;
};
struct MarkLine {
  std::vector<std::pair<double, double>> points = {};
  bool dashed = false, stairs = false; // stairs: first right, then down
};
struct Scatter {
  std::string title, xLabel, yLabel;
  std::vector<Mark> marks;
  std::vector<MarkLine> lines;
  std::vector<std::pair<MarkShape, std::string>> legend = {}; // at the upper right
};

/// So many side by side; each frame of this size in pixels.
std::string svgOf(const std::vector<Scatter>& plots, size_t perRow, int width, int height);

} // namespace lambent
