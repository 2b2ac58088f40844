#include "tools/lambent/scatter.h"

#include "tools/lambent/html.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr double kLeft = 64, kTop = 26, kBelow = 46, kRight = 18; // around the frame, pixels

/// A logarithmic axis over what is shown, with some room.
struct LogAxis {
  double low = 0, high = 1; // decimal logarithms
  double from = 0, to = 1;  // pixels

  void fit(double least, double most) {
    const double middle = 0.5 * (std::log10(least) + std::log10(most));
    const double half = std::max(0.56 * (std::log10(most) - std::log10(least)), 0.1);
    low = middle - half, high = middle + half;
  }
  double at(double value) const { return from + (to - from) * (std::log10(value) - low) / (high - low); }

  /// Powers of ten over more than three decades; over less 1, 2, 5 times these; over half a decade every digit.
  std::vector<double> ticks() const {
    std::vector<double> values;
    for (int power = int(std::floor(low)); power <= int(std::ceil(high)); ++power)
      for (int digit = 1; digit < 10; ++digit) {
        const bool named = digit == 1 || (high - low <= 3 && (digit == 2 || digit == 5)) || high - low < 0.6;
        const double value = digit * std::pow(10, power);
        if (named && std::log10(value) >= low && std::log10(value) <= high) values.push_back(value);
      }
    return values;
  }
};

std::string shapeAt(MarkShape shape, double x, double y, double r) {
  switch (shape) {
  case MarkShape::Dot:
    return format("<circle cx='%.1f' cy='%.1f' r='%.1f'/>", x, y, r);
  case MarkShape::Square:
    return format("<rect x='%.1f' y='%.1f' width='%.1f' height='%.1f'/>", x - r, y - r, 2 * r, 2 * r);
  case MarkShape::Triangle:
    return format("<path d='M%.1f %.1fl%.1f %.1fh%.1fz'/>", x, y - 1.2 * r, 1.2 * r, 2.1 * r, -2.4 * r);
  case MarkShape::Diamond:
    return format("<path d='M%.1f %.1fl%.1f %.1fl%.1f %.1fl%.1f %.1fz'/>", x, y - 1.3 * r, 1.3 * r, 1.3 * r, -1.3 * r,
                  1.3 * r, -1.3 * r, -1.3 * r);
  }
  return "";
}

std::string frameOf(const Scatter& plot, const LogAxis& x, const LogAxis& y) {
  std::string out = format("<text class='title' x='%.0f' y='16'>", x.from) + escaped(plot.title) + "</text>\n";
  for (double value : x.ticks())
    out += format("<path d='M%.1f %.0fV%.0f' stroke='#ddd'/><text x='%.1f' y='%.0f' text-anchor='middle'>%g</text>\n",
                  x.at(value), y.from, y.to, x.at(value), y.from + 16, value);
  for (double value : y.ticks())
    out += format("<path d='M%.0f %.1fH%.0f' stroke='#ddd'/><text x='%.0f' y='%.1f' text-anchor='end'>%g</text>\n",
                  x.from, y.at(value), x.to, x.from - 6, y.at(value) + 4, value);
  out += format("<rect x='%.0f' y='%.0f' width='%.0f' height='%.0f' fill='none' stroke='#555'/>\n", x.from, y.to,
                x.to - x.from, y.from - y.to);
  out += format("<text x='%.0f' y='%.0f' text-anchor='middle'>", 0.5 * (x.from + x.to), y.from + 36) +
         escaped(plot.xLabel) + "</text>\n";
  out += format("<text transform='translate(14 %.0f) rotate(-90)' text-anchor='middle'>", 0.5 * (y.from + y.to)) +
         escaped(plot.yLabel) + "</text>\n";
  return out;
}

std::string marksOf(const Scatter& plot, const LogAxis& x, const LogAxis& y) {
  std::string out;
  for (const MarkLine& line : plot.lines) {
    out += std::string("<path fill='none' stroke='#333'") + (line.dashed ? " stroke-dasharray='4 3'" : "") + " d='";
    for (size_t i = 0; i < line.points.size(); ++i) {
      const double px = x.at(line.points[i].first), py = y.at(line.points[i].second);
      out += i == 0        ? format("M%.1f %.1f", px, py)
             : line.stairs ? format("H%.1fV%.1f", px, py)
                           : format("L%.1f %.1f", px, py);
    }
    out += "'/>\n";
  }
  for (const Mark& m : plot.marks) {
    const double px = x.at(m.x), py = y.at(m.y);
    out += format("<g stroke='#333' fill='%s'>", m.filled ? "#333" : "#fff");
    if (m.yNoise > 0)
      out += format("<path d='M%.1f %.1fV%.1f'/>", px, y.at(m.y / (1 + m.yNoise)), y.at(m.y * (1 + m.yNoise)));
    if (m.xNoise > 0)
      out += format("<path d='M%.1f %.1fH%.1f'/>", x.at(m.x / (1 + m.xNoise)), py, x.at(m.x * (1 + m.xNoise)));
    out += shapeAt(m.shape, px, py, m.filled ? 4.5 : 3.5) + "<title>" + escaped(m.name) + "</title></g>";
    if (!m.label.empty()) out += format("<text x='%.1f' y='%.1f'>", px + 7, py - 6) + escaped(m.label) + "</text>";
    out += "\n";
  }
  for (size_t i = 0; i < plot.legend.size(); ++i) {
    const double line = y.to + 16 + 16 * double(i);
    out += "<g stroke='#333' fill='#fff'>" + shapeAt(plot.legend[i].first, x.to - 8, line - 4, 3.5) + "</g>";
    out += format("<text x='%.1f' y='%.1f' text-anchor='end'>", x.to - 18, line) + escaped(plot.legend[i].second) +
           "</text>\n";
  }
  return out;
}

} // namespace

std::string svgOf(const std::vector<Scatter>& plots, size_t perRow, int width, int height) {
  const double cellWidth = kLeft + width + kRight, cellHeight = kTop + height + kBelow;
  const size_t rows = (plots.size() + perRow - 1) / perRow;
  const double wide = cellWidth * double(std::min(perRow, plots.size())), high = cellHeight * double(rows);
  std::string out =
      format("<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' viewBox='0 0 %.0f %.0f'>", wide, high,
             wide, high) +
      "<style>text{font:12px sans-serif}.title{font-weight:bold}</style>"
      "<rect width='100%' height='100%' fill='#fff'/>\n";
  for (size_t i = 0; i < plots.size(); ++i) {
    const Scatter& plot = plots[i];
    LogAxis x{.from = kLeft, .to = kLeft + width}, y{.from = kTop + height, .to = kTop};
    double least[2] = {1e300, 1e300}, most[2] = {0, 0};
    for (const Mark& m : plot.marks) {
      least[0] = std::min(least[0], m.x), most[0] = std::max(most[0], m.x);
      least[1] = std::min(least[1], m.y / (1 + m.yNoise)), most[1] = std::max(most[1], m.y * (1 + m.yNoise));
    }
    if (plot.marks.empty()) continue;
    x.fit(least[0], most[0]), y.fit(least[1], most[1]);
    out += format("<g transform='translate(%.0f %.0f)'>\n", cellWidth * double(i % perRow),
                  cellHeight * double(i / perRow)) +
           frameOf(plot, x, y) + marksOf(plot, x, y) + "</g>\n";
  }
  return out + "</svg>\n";
}

} // namespace lambent
