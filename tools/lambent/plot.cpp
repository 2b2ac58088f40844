#include "tools/lambent/plot.h"

#include "engine/core/error.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace lambent {

namespace {

constexpr double kWidth = 420, kHeight = 240; // of the frame, pixels
constexpr double kLeft = 60, kTop = 34, kBelow = 52, kRight = 28;
constexpr const char* kColours[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#8c564b", "#e377c2"};

/// The least of 1, 2, 5 times a power of ten that reaches `most` in five steps.
double stepFor(double most) {
  const double power = std::pow(10, std::floor(std::log10(most / 5)));
  for (double factor : {1.0, 2.0, 5.0})
    if (factor * power * 5 >= most * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

class Axes {
 public:
  explicit Axes(const Plot& plot) {
    double most = 0, least = INFINITY;
    for (const PlotSeries& s : plot.series)
      for (double y : s.y) {
        if (std::isfinite(y)) most = std::max(most, y);
        if (y > 0) least = std::min(least, y);
      }
    if (plot.logarithmic && most > 0) {
      logarithmic_ = true;
      bottom_ = std::floor(std::log10(least) + 1e-9);
      decades_ = std::max(1.0, std::ceil(std::log10(most) - 1e-9) - bottom_);
      for (int i = 0; i <= decades_; ++i) ticks.push_back(std::pow(10, bottom_ + i));
    } else {
      const double step = stepFor(most > 0 ? most : 1);
      top_ = step * std::max(1.0, std::ceil(most / step - 1e-9));
      for (double y = 0; y <= top_ * (1 + 1e-9); y += step) ticks.push_back(y);
    }
    if (plot.even) {
      even_ = true;
      low_ = plot.x.front();
      span_ = std::max(plot.x.back() - low_, 1e-3);
      return;
    }
    zero_ = plot.x.front() == 0;
    const double first = zero_ && plot.x.size() > 1 ? plot.x[1] : plot.x.front();
    low_ = std::log10(first > 0 ? first : 1) - (zero_ ? 0.5 : 0);
    const double last = plot.x.back() > 0 ? std::log10(plot.x.back()) : low_;
    span_ = std::max(last - low_, 1e-3);
  }

  double x(double value) const {
    if (even_) return kLeft + kWidth * (value - low_) / span_;
    return kLeft + kWidth * (value > 0 ? (std::log10(value) - low_) / span_ : 0);
  }
  double y(double value) const {
    const double share = logarithmic_ ? (std::log10(value) - bottom_) / decades_ : value / top_;
    return kTop + kHeight * (1 - share);
  }
  bool shows(double value) const { return std::isfinite(value) && (value > 0 || !logarithmic_); }
  bool zero() const { return zero_; }

  std::vector<double> ticks; // of y

 private:
  double top_ = 1;
  bool logarithmic_ = false;
  double bottom_ = 0, decades_ = 1; // of y
  double low_ = 0, span_ = 1;       // decades, or as they are
  bool zero_ = false, even_ = false;
};

void drawFrame(std::ostringstream& out, const Plot& plot, const Axes& axes) {
  const double bottom = kTop + kHeight;
  out << format("<rect x='%.0f' y='%.0f' width='%.0f' height='%.0f' fill='none' stroke='#888'/>\n", kLeft, kTop, kWidth,
                kHeight);
  out << "<text class='title' x='" << kLeft << "' y='16'>" << plot.title << "</text>\n";
  for (double y : axes.ticks)
    out << format("<path d='M%.0f %.1fh%.0f' stroke='#ddd'/><text x='%.0f' y='%.1f' text-anchor='end'>%g</text>\n",
                  kLeft, axes.y(y), kWidth, kLeft - 6, axes.y(y) + 4, y);
  std::vector<double> ticks = plot.x;
  if (plot.even) {
    ticks.clear();
    const double low = plot.x.front(), high = plot.x.back(), step = stepFor(high > low ? high - low : 1);
    for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
      ticks.push_back(i * step + 0.0); // no -0
  }
  for (double x : ticks)
    out << format("<path d='M%.1f %.0fv5' stroke='#888'/><text x='%.1f' y='%.0f' text-anchor='middle'>%g</text>\n",
                  axes.x(x), bottom, axes.x(x), bottom + 18, x);
  if (axes.zero() && plot.x.size() > 1) {
    const double gap = 0.5 * (axes.x(0) + axes.x(plot.x[1]));
    out << format("<path d='M%.1f %.0fl4 -10m4 0l-4 10' stroke='#888'/>\n", gap - 4, bottom + 5);
  }
  out << format("<text x='%.0f' y='%.0f' text-anchor='middle'>", kLeft + 0.5 * kWidth, bottom + 40) << plot.xLabel
      << "</text>\n";
  out << format("<text transform='translate(14 %.0f) rotate(-90)' text-anchor='middle'>", kTop + 0.5 * kHeight)
      << plot.yLabel << "</text>\n";
}

const char* colourOf(const Plot& plot, size_t s) {
  return plot.series[s].colour ? plot.series[s].colour : kColours[s % std::size(kColours)];
}

void drawSeries(std::ostringstream& out, const Plot& plot, const Axes& axes) {
  if (plot.marked)
    out << format("<path d='M%.1f %.0fv%.0f' stroke='#888' stroke-dasharray='4 3'/>\n", axes.x(plot.x[*plot.marked]),
                  kTop, kHeight);
  for (size_t s = 0; s < plot.series.size(); ++s) {
    const PlotSeries& series = plot.series[s];
    const char* colour = colourOf(plot, s);
    out << "<polyline fill='none' stroke-width='1.5' stroke='" << colour << "' points='";
    for (size_t i = 0; i < plot.x.size(); ++i)
      if (axes.shows(series.y[i])) out << format("%.1f,%.1f ", axes.x(plot.x[i]), axes.y(series.y[i]));
    out << "'/>\n";
    for (size_t i = 0; plot.marked && i < plot.x.size(); ++i)
      out << format("<circle cx='%.1f' cy='%.1f' r='%d' fill='%s' stroke='%s'/>\n", axes.x(plot.x[i]),
                    axes.y(series.y[i]), i == plot.marked ? 5 : 3, i == plot.marked ? "#fff" : colour, colour);
  }
  for (size_t s = 0; s < plot.series.size(); ++s) // above all lines
    out << format("<text class='name' x='%.0f' y='%.0f' fill='%s'>", kLeft + 10, kTop + 18 + 16 * double(s),
                  colourOf(plot, s))
        << plot.series[s].name << "</text>\n";
}

} // namespace

std::string svgOf(const std::vector<Plot>& plots, size_t perRow) {
  constexpr double width = kLeft + kWidth + kRight, height = kTop + kHeight + kBelow;
  std::ostringstream out;
  out << format("<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f'>\n",
                width * double(std::clamp<size_t>(plots.size(), 1, perRow)),
                height * double((plots.size() + perRow - 1) / perRow))
      << "<style>text{font:12px sans-serif}.title{font-weight:bold}"
         ".name{paint-order:stroke;stroke:#fff;stroke-width:3px}</style><rect width='100%' height='100%' "
         "fill='#fff'/>\n";
  for (size_t i = 0; i < plots.size(); ++i) {
    const Plot& plot = plots[i];
    CHECK(!plot.x.empty());
    const Axes axes(plot);
    out << format("<g transform='translate(%.0f %.0f)'>\n", width * double(i % perRow), height * double(i / perRow));
    drawFrame(out, plot, axes);
    drawSeries(out, plot, axes);
    out << "</g>\n";
  }
  out << "</svg>\n";
  return out.str();
}

} // namespace lambent
