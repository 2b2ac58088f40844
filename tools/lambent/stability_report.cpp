#include "tools/lambent/stability_report.h"

#include "gi/plan/techniques.h"

#include "gi/plan/settings.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Paper 1, table 1: |E'| of smc over that of ir in the sequence that a shot of ours follows.
struct Published {
  const char* shot;
  double smcOverIr;
};
constexpr std::array<Published, 5> kPublished{
    {{"office", 0.57}, {"citadel", 0.61}, {"maze", 0.57}, {"atrium", 0.32}, {"citadel-moving", 0.22}}};

std::string publishedRatio(std::string shot) {
  if (shot.ends_with("-small")) shot.resize(shot.size() - 6);
  for (const Published& p : kPublished)
    if (shot == p.shot) return format("%.2f", p.smcOverIr);
  return "";
}

/// |E| over what it is while the scene stands still: marked, grid.
std::string overStill(const ShotRun& shot, const TechniqueRun& t) {
  if (!shot.still) return "";
  return format("%.2f, %.2f", t.marked.error / t.stillMarked.error, t.grid.error / t.stillGrid.error);
}

std::string vplsText(const TechniqueRun& t) { return t.vpls > 0 ? format("%u", t.vpls) : "cut"; }

/// What |E'| is held against: that of ir as in paper 1, among techniques from reflective maps that of rsm.
const TechniqueRun* simplestOf(const ShotRun& shot, const TechniqueRun& t) {
  Settings settings;
  applyTechnique(settings, t.name);
  const TechniqueRun* simplest = shot.technique(rowOf(settings.vpl.source).reflective ? "rsm" : "ir");
  return simplest && simplest->grid.change > 0 ? simplest : nullptr;
}

std::string latencyText(const Latency& l) {
  return l.count ? format("%.0f, %.0f, %.0f %%", l.median, l.worstTenth, 100 * l.followed) : "";
}

std::string csv(const std::vector<ShotRun>& shots) {
  std::ostringstream out;
  out << "shot,technique,vpls,frames,error_marked,change_marked,error_grid,change_grid,bias_grid,error_still_marked,"
         "error_still_grid,l90_median,l90_worst_tenth,l90_followed,l90_count,place_ms,truth_error\n";
  for (const ShotRun& s : shots)
    for (const TechniqueRun& t : s.techniques)
      out << s.name << ',' << t.name << ',' << t.vpls << ',' << s.truth.size() << ',' << t.marked.error << ','
          << t.marked.change << ',' << t.grid.error << ',' << t.grid.change << ',' << t.grid.bias << ','
          << (s.still ? format("%g,%g,", t.stillMarked.error, t.stillGrid.error) : ",,") << t.latency.median << ','
          << t.latency.worstTenth << ',' << t.latency.followed << ',' << t.latency.count << ','
          << format("%.3f", t.placeMs) << ',' << s.truthError << '\n';
  return out.str();
}

std::string seriesCsv(const ShotRun& s) {
  std::ostringstream out;
  out << "frame,pixel,marked,truth";
  for (const TechniqueRun& t : s.techniques) out << ',' << t.name;
  out << '\n';
  for (size_t f = 0; f < s.truth.size(); ++f)
    for (size_t p = 0; p < s.truth[f].size(); ++p) {
      out << f << ',' << p << ',' << (p < s.marked) << ',' << s.truth[f][p];
      for (const TechniqueRun& t : s.techniques) out << ',' << t.series[f][p];
      out << '\n';
    }
  return out.str();
}

const char* colourOf(size_t technique) {
  static const char* const colours[] = {"#d62728", "#1f77b4", "#2ca02c", "#9467bd", "#8c564b", "#e377c2"};
  return colours[technique % std::size(colours)];
}

/// Luminance of one pixel over time, as paper 1, fig. 7.
std::string plot(const ShotRun& s, size_t pixel) {
  constexpr double width = 420, height = 150, left = 40, bottom = 18;
  float lo = kInfinity, hi = -kInfinity;
  const auto widen = [&](const PixelSeries& series) {
    for (const auto& frame : series)
      if (!std::isnan(frame[pixel])) lo = std::min(lo, frame[pixel]), hi = std::max(hi, frame[pixel]);
  };
  widen(s.truth);
  for (const TechniqueRun& t : s.techniques) widen(t.series);
  if (!(hi >= lo)) return ""; // never on a surface
  hi = std::max(hi, lo + 1e-3f);
  std::ostringstream out;
  out << format("<svg width='%.0f' height='%.0f'><rect x='%.0f' y='0' width='%.0f' height='%.0f' fill='none' "
                "stroke='#ccc'/>",
                width + left, height + bottom, left, width, height);
  const auto line = [&](const PixelSeries& series, const char* colour, double strength) {
    out << "<polyline fill='none' stroke='" << colour << "' stroke-width='" << strength << "' points='";
    for (size_t f = 0; f < series.size(); ++f)
      if (!std::isnan(series[f][pixel]))
        out << format("%.1f,%.1f ", left + width * double(f) / double(std::max<size_t>(1, series.size() - 1)),
                      height * (1 - double(series[f][pixel] - lo) / double(hi - lo)));
    out << "'/>";
  };
  for (size_t t = 0; t < s.techniques.size(); ++t) line(s.techniques[t].series, colourOf(t), 1);
  line(s.truth, "#000", 1.6);
  out << format("<text x='0' y='12'>%.3f</text><text x='0' y='%.0f'>%.3f</text><text x='%.0f' y='%.0f'>0 s</text>"
                "<text x='%.0f' y='%.0f' text-anchor='end'>%.2g s</text></svg>\n",
                double(hi), height, double(lo), left, height + 14, left + width, height + 14,
                double(s.truth.size() - 1) / s.fps);
  return out.str();
}

std::string html(const std::vector<ShotRun>& shots, const std::string& conditions) {
  std::ostringstream out;
  out << "<!doctype html><meta charset='utf-8'><title>Temporal stability</title><style>body{font:14px sans-serif;"
         "max-width:75em;margin:2em auto}table{border-collapse:collapse}td,th{padding:.2em .7em;border-bottom:1px "
         "solid #ddd;text-align:right}td:nth-child(-n+2){text-align:left}svg text{font:10px sans-serif}</style>\n"
      << "<h1>Temporal stability</h1><p>" << conditions
      << "</p><p>E = technique − truth in tone-mapped luminance, E' its change from frame to frame (paper 1, table 1). "
         "L90: frames until 90 % of a step of the scene is followed.</p>\n<table><tr><th>shot<th>technique<th>N<th>|E| "
         "marked<th>|E'| marked<th>|E| grid<th>|E'| grid<th>bias<th>|E| over still<th>L90 median, worst tenth, share "
         "followed<th>ms to place</tr>\n";
  for (const ShotRun& s : shots)
    for (const TechniqueRun& t : s.techniques)
      out << "<tr><td>" << s.name << "<td>" << t.name
          << format("<td>%s<td>%.4f<td>%.4f<td>%.4f<td>%.4f<td>%+.4f", vplsText(t).c_str(), t.marked.error,
                    t.marked.change, t.grid.error, t.grid.change, t.grid.bias)
          << "<td>" << overStill(s, t) << "<td>" << latencyText(t.latency) << format("<td>%.1f</tr>\n", t.placeMs);
  out << "</table>\n";
  for (const ShotRun& s : shots) {
    out << "<h2>" << s.name << "</h2><p><b>truth</b>";
    for (size_t t = 0; t < s.techniques.size(); ++t)
      out << " <b style='color:" << colourOf(t) << "'>" << s.techniques[t].name << "</b>";
    out << "; one plot per marked pixel</p>\n";
    for (size_t p = 0; p < s.marked; ++p) out << plot(s, p);
  }
  return out.str();
}

} // namespace

const TechniqueRun* ShotRun::technique(const std::string& wanted) const {
  for (const TechniqueRun& t : techniques)
    if (t.name == wanted) return &t;
  return nullptr;
}

std::string stabilityTable(const std::vector<ShotRun>& shots) {
  std::ostringstream out;
  out << "| shot | technique | N | \\|E\\| marked | \\|E'\\| marked | \\|E\\| grid | \\|E'\\| grid | bias | \\|E'\\| "
         "over ir's, rsm's | paper 1 | \\|E\\| over still | L90, worst tenth, followed | ms to place |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const ShotRun& s : shots) {
    for (const TechniqueRun& t : s.techniques) {
      const TechniqueRun* simplest = simplestOf(s, t);
      out << "| " << s.name << " | " << t.name << " | " << vplsText(t)
          << format(" | %.4f | %.4f | %.4f | %.4f | %+.4f | ", t.marked.error, t.marked.change, t.grid.error,
                    t.grid.change, t.grid.bias)
          << (simplest ? format("%.2f", t.grid.change / simplest->grid.change) : "") << " | "
          << (t.name == "smc" ? publishedRatio(s.name) : "") << " | " << overStill(s, t) << " | "
          << latencyText(t.latency) << format(" | %.1f |\n", t.placeMs);
    }
  }
  return out.str();
}

void writeStabilityReport(const fs::path& folder, const std::vector<ShotRun>& shots, const std::string& conditions) {
  writeText(folder / "stability.csv", csv(shots));
  writeText(folder / "stability.md", "# Temporal stability\n\n" + conditions + "\n\n" + stabilityTable(shots));
  writeText(folder / "stability.html", html(shots, conditions));
  for (const ShotRun& s : shots) writeText(folder / ("series-" + s.name + ".csv"), seriesCsv(s));
}

} // namespace lambent
