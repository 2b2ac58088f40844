#include "tools/lambent/plot.h"

#include "engine/core/error.h"
#include "tools/lambent/report.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr double kLeft = 64, kTop = 30, kBelow = 50, kRight = 24; // around the frame, pixels
constexpr const char* kColours[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#8c564b", "#e377c2"};

/// The least of 1, 2, 5 times a power of ten that reaches `most` in five steps.
double stepFor(double most) {
  const double power = std::pow(10, std::floor(std::log10(most / 5)));
  for (double factor : {1.0, 2.0, 5.0})
    if (factor * power * 5 >= most * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

/// Where values stand between two edges of the frame, and which of them are written there.
class Axis {
 public:
  Axis(double from, double to, bool logarithmic) : from_(from), to_(to), log_(logarithmic) {}

  /// From `least` to a round number that reaches `most`, or just there.
  void even(double least, double most, bool round) {
    const double step = stepFor(most > least ? most - least : 1);
    low_ = least, high_ = round ? step * std::max(1.0, std::ceil(most / step - 1e-9)) : std::max(most, least + 1e-3);
    for (double i = std::ceil(low_ / step - 1e-9); i * step <= high_ + 1e-9 * step; ++i)
      ticks.push_back(i * step + 0.0); // no -0
  }

  /// Over what is shown, with some room. Powers of ten over more than three decades; over less 1, 2, 5 times these;
  /// over half a decade every digit.
  void logarithmic(double least, double most) {
    const double middle = 0.5 * (std::log10(least) + std::log10(most));
    const double half = std::max(0.56 * (std::log10(most) - std::log10(least)), 0.1);
    low_ = middle - half, high_ = middle + half;
    for (int power = int(std::floor(low_)); power <= int(std::ceil(high_)); ++power)
      for (int digit = 1; digit < 10; ++digit) {
        const bool named = digit == 1 || (high_ - low_ <= 3 && (digit == 2 || digit == 5)) || high_ - low_ < 0.6;
        const double value = digit * std::pow(10, power);
        if (named && std::log10(value) >= low_ && std::log10(value) <= high_) ticks.push_back(value);
      }
  }

  /// At these values, ascending, of which the first may be 0.
  void atValues(const std::vector<double>& values) {
    ticks = values;
    const double first = values[0] > 0 || values.size() < 2 ? values[0] : values[1];
    low_ = (first > 0 ? std::log10(first) : 0) - (values[0] > 0 ? 0 : 0.5);
    high_ = std::max(values.back() > 0 ? std::log10(values.back()) : low_, low_ + 1e-3);
  }

  double at(double value) const {
    if (log_) value = value > 0 ? std::log10(value) : low_;
    return from_ + (to_ - from_) * (value - low_) / (high_ - low_);
  }
  bool shows(double value) const { return std::isfinite(value) && (value >= 0 || !log_); }

  std::vector<double> ticks = {};

 private:
  double from_, to_; // pixels
  bool log_;
  double low_ = 0, high_ = 1; // decimal logarithms, or as they are
};

/// The least above 0, and the most.
struct Extent {
  double least = INFINITY, most = 0;
  void add(double value) {
    if (std::isfinite(value)) most = std::max(most, value);
    if (value > 0) least = std::min(least, value);
  }
};

std::string shapeAt(Shape shape, double x, double y, double r) {
  switch (shape) {
  case Shape::Dot:
    return format("<circle cx='%.1f' cy='%.1f' r='%.1f'/>", x, y, r);
  case Shape::Square:
    return format("<rect x='%.1f' y='%.1f' width='%.1f' height='%.1f'/>", x - r, y - r, 2 * r, 2 * r);
  case Shape::Triangle:
    return format("<path d='M%.1f %.1fl%.1f %.1fh%.1fz'/>", x, y - 1.2 * r, 1.2 * r, 2.1 * r, -2.4 * r);
  case Shape::Diamond:
    return format("<path d='M%.1f %.1fl%.1f %.1fl%.1f %.1fl%.1f %.1fz'/>", x, y - 1.3 * r, 1.3 * r, 1.3 * r, -1.3 * r,
                  1.3 * r, -1.3 * r, -1.3 * r);
  }
  return "";
}

std::string textAt(double x, double y, const char* attributes, const std::string& text) {
  return format("<text x='%.1f' y='%.1f' %s>", x, y, attributes) + escaped(text) + "</text>\n";
}

std::string lineOf(const PlotLine& line, const char* colour, const Axis& x, const Axis& y) {
  std::string out = format("<path fill='none' stroke='%s'%s d='", colour, line.dashed ? " stroke-dasharray='4 3'" : "");
  bool begun = false;
  for (size_t i = 0; i < line.x.size(); ++i) {
    if (!y.shows(line.y[i])) continue;
    const double px = x.at(line.x[i]), py = y.at(line.y[i]);
    out += !begun        ? format("M%.1f %.1f", px, py)
           : line.stairs ? format("H%.1fV%.1f", px, py)
                         : format("L%.1f %.1f", px, py);
    begun = true;
  }
  return out + "'/>\n";
}

std::string markOf(const PlotMark& m, const Axis& x, const Axis& y) {
  const double px = x.at(m.x), py = y.at(m.y);
  std::string out = format("<g stroke='#333' fill='%s'>", m.filled ? "#333" : "#fff");
  if (m.yNoise > 0)
    out += format("<path d='M%.1f %.1fV%.1f'/>", px, y.at(m.y / (1 + m.yNoise)), y.at(m.y * (1 + m.yNoise)));
  if (m.xNoise > 0)
    out += format("<path d='M%.1f %.1fH%.1f'/>", x.at(m.x / (1 + m.xNoise)), py, x.at(m.x * (1 + m.xNoise)));
  out += shapeAt(m.shape, px, py, m.filled ? 4.5 : 3.5) + "<title>" + escaped(m.name) + "</title></g>";
  return out + (m.label.empty() ? "\n" : textAt(px + 7, py - 6, "", m.label));
}

std::string drawn(const Plot& plot, double width, double height) {
  const double left = kLeft, right = kLeft + width, top = kTop, bottom = kTop + height;
  Extent ofX, ofY;
  for (const PlotLine& line : plot.lines)
    for (size_t i = 0; i < line.x.size(); ++i) ofX.add(line.x[i]), ofY.add(line.y[i]);
  for (const PlotMark& m : plot.marks) ofX.add(m.x), ofY.add(m.y / (1 + m.yNoise)), ofY.add(m.y * (1 + m.yNoise));
  Axis x(left, right, plot.logX), y(bottom, top, plot.logY && ofY.most > 0);
  if (plot.ticksAtValues)
    x.atValues(plot.lines[0].x);
  else if (plot.logX)
    x.logarithmic(ofX.least, ofX.most);
  else
    x.even(plot.lines[0].x.front(), plot.lines[0].x.back(), false);
  if (plot.logY && ofY.most > 0)
    y.logarithmic(ofY.least, ofY.most);
  else
    y.even(0, ofY.most, true);

  std::string out = textAt(left, 16, "class='title'", plot.title);
  for (double value : x.ticks)
    out += format("<path d='M%.1f %.0fV%.0f' stroke='#ddd'/>", x.at(value), bottom, top) +
           textAt(x.at(value), bottom + 16, "text-anchor='middle'", format("%g", value));
  for (double value : y.ticks)
    out += format("<path d='M%.0f %.1fH%.0f' stroke='#ddd'/>", left, y.at(value), right) +
           textAt(left - 6, y.at(value) + 4, "text-anchor='end'", format("%g", value));
  if (plot.ticksAtValues && x.ticks[0] == 0 && x.ticks.size() > 1) // a gap in the axis
    out += format("<path d='M%.1f %.0fl4 -10m4 0l-4 10' stroke='#888'/>\n", 0.5 * (x.at(0) + x.at(x.ticks[1])) - 4,
                  bottom + 5);
  out += format("<rect x='%.0f' y='%.0f' width='%.0f' height='%.0f' fill='none' stroke='#555'/>\n", left, top, width,
                height);
  out += textAt(0.5 * (left + right), bottom + 36, "text-anchor='middle'", plot.xLabel);
  out += format("<text transform='translate(14 %.0f) rotate(-90)' text-anchor='middle'>", 0.5 * (top + bottom)) +
         escaped(plot.yLabel) + "</text>\n";

  if (plot.inUse)
    out += format("<path d='M%.1f %.0fV%.0f' stroke='#888' stroke-dasharray='4 3'/>\n", x.at(*plot.inUse), bottom, top);
  std::string names; // above all lines
  for (size_t i = 0; i < plot.lines.size(); ++i) {
    const PlotLine& line = plot.lines[i];
    const char* colour = line.colour ? line.colour : line.name.empty() ? "#333" : kColours[i % std::size(kColours)];
    out += lineOf(line, colour, x, y);
    for (size_t k = 0; plot.inUse && k < line.x.size(); ++k) {
      const bool used = line.x[k] == *plot.inUse;
      out += format("<g fill='%s' stroke='%s'>", used ? "#fff" : colour, colour) +
             shapeAt(Shape::Dot, x.at(line.x[k]), y.at(line.y[k]), used ? 5 : 3) + "</g>\n";
    }
    if (!line.name.empty())
      names +=
          textAt(left + 10, top + 18 + 16 * double(i), format("class='name' fill='%s'", colour).c_str(), line.name);
  }
  for (const PlotMark& m : plot.marks) out += markOf(m, x, y);
  for (size_t i = 0; i < plot.legend.size(); ++i) {
    const double line = top + 16 + 16 * double(i);
    out += "<g stroke='#333' fill='#fff'>" + shapeAt(plot.legend[i].first, right - 8, line - 4, 3.5) + "</g>" +
           textAt(right - 18, line, "text-anchor='end'", plot.legend[i].second);
  }
  return out + names;
}

} // namespace

std::string svgOf(const std::vector<Plot>& plots, size_t perRow, int width, int height) {
  const double cellWidth = kLeft + width + kRight, cellHeight = kTop + height + kBelow;
  const double wide = cellWidth * double(std::clamp<size_t>(plots.size(), 1, perRow)),
               high = cellHeight * double((plots.size() + perRow - 1) / perRow);
  std::string out =
      format("<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' viewBox='0 0 %.0f %.0f'>", wide, high,
             wide, high) +
      "<style>text{font:12px sans-serif}.title{font-weight:bold}.name{paint-order:stroke;stroke:#fff;stroke-width:3px}"
      "</style><rect width='100%' height='100%' fill='#fff'/>\n";
  for (size_t i = 0; i < plots.size(); ++i) {
    if (plots[i].lines.empty() && plots[i].marks.empty()) continue;
    out += format("<g transform='translate(%.0f %.0f)'>\n", cellWidth * double(i % perRow),
                  cellHeight * double(i / perRow)) +
           drawn(plots[i], width, height) + "</g>\n";
  }
  return out + "</svg>\n";
}

} // namespace lambent
