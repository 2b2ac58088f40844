#include "tools/lambent/stability_report.h"

#include "gi/plan/settings.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Paper 1, table 1: |E'| of smc over that of ir in the sequence that a shot of ours follows.
const std::map<std::string, double> kPublished{
    {"office", 0.57}, {"citadel", 0.61}, {"maze", 0.57}, {"atrium", 0.32}, {"citadel-moving", 0.22}};

/// What |E'| is held against: that of ir as in paper 1, among techniques from reflective maps that of rsm.
const TechniqueRun* simplestOf(const ShotRun& shot, const TechniqueRun& t) {
  Settings settings;
  applyTechnique(settings, t.name);
  const TechniqueRun* simplest = shot.technique(fromReflectiveMaps(settings.vpl.source) ? "rsm" : "ir");
  return simplest && simplest->grid.change > 0 ? simplest : nullptr;
}

nlohmann::json figuresOf(const ShotRun& s, const TechniqueRun& t) {
  nlohmann::json j{{"shot", s.name},
                   {"technique", t.name},
                   {"vpls", t.vpls},
                   {"frames", s.truth.size()},
                   {"pixels_marked", s.marked},
                   {"pixels_grid", s.truth.front().size() - s.marked},
                   {"steps", s.steps},
                   {"error_marked", t.marked.error},
                   {"change_marked", t.marked.change},
                   {"error_grid", t.grid.error},
                   {"change_grid", t.grid.change},
                   {"bias_grid", t.grid.bias},
                   {"l90_median", t.latency.median},
                   {"l90_worst_tenth", t.latency.worstTenth},
                   {"l90_followed", t.latency.followed},
                   {"l90_count", t.latency.count},
                   {"place_ms", t.placeMs},
                   {"truth_error", s.truthError}};
  if (t.latency.count > 0) j["l90"] = {t.latency.median, t.latency.worstTenth, 100 * t.latency.followed};
  if (const TechniqueRun* simplest = simplestOf(s, t))
    j["change_over_simplest"] = t.grid.change / simplest->grid.change;
  const auto published = kPublished.find(s.name.substr(0, s.name.find("-small")));
  if (t.name == "smc" && published != kPublished.end()) j["paper_1"] = published->second;
  if (!s.still) return j;
  j["error_still_marked"] = t.stillMarked.error;
  j["error_still_grid"] = t.stillGrid.error;
  j["error_over_still"] = {t.marked.error / t.stillMarked.error, t.grid.error / t.stillGrid.error};
  return j;
}

const std::vector<TableColumn> kColumns{{"shot", "shot"},
                                        {"technique", "technique"},
                                        {"vpls", "N", "%g", 1, "cut"},
                                        {"error_marked", "\\|E\\| marked", "%.4f"},
                                        {"change_marked", "\\|E'\\| marked", "%.4f"},
                                        {"error_grid", "\\|E\\| grid", "%.4f"},
                                        {"change_grid", "\\|E'\\| grid", "%.4f"},
                                        {"bias_grid", "bias", "%+.4f"},
                                        {"change_over_simplest", "\\|E'\\| over ir's, rsm's", "%.2f"},
                                        {"paper_1", "paper 1", "%.2f"},
                                        {"error_over_still", "\\|E\\| over still", "%.2f"},
                                        {"l90", "L90, worst tenth, % followed", "%.0f"},
                                        {"place_ms", "ms to place", "%.1f"}};

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

std::string html(const std::vector<ShotRun>& shots, const nlohmann::json& figures, const std::string& conditions) {
  std::ostringstream out;
  out << "<!doctype html><meta charset='utf-8'><title>Temporal stability</title><style>body{font:14px sans-serif;"
         "max-width:75em;margin:2em auto}table{border-collapse:collapse}td,th{padding:.2em .7em;border-bottom:1px "
         "solid #ddd;text-align:right}td:nth-child(-n+2){text-align:left}svg text{font:10px sans-serif}</style>\n"
      << "<h1>Temporal stability</h1><p>" << conditions
      << "</p><p>E = technique − truth in tone-mapped luminance, E' its change from frame to frame (paper 1, table 1). "
         "L90: frames until 90 % of a step of the scene is followed.</p>\n<table><tr>";
  for (const TableColumn& c : kColumns) {
    std::string title = c.title;
    std::erase(title, '\\');
    out << "<th>" << title;
  }
  for (const nlohmann::json& row : figures) {
    out << "</tr>\n<tr>";
    for (const TableColumn& c : kColumns) out << "<td>" << cellText(c, row);
  }
  out << "</tr>\n</table>\n";
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

nlohmann::json stabilityFigures(const std::vector<ShotRun>& shots) {
  nlohmann::json figures = nlohmann::json::array();
  for (const ShotRun& s : shots)
    for (const TechniqueRun& t : s.techniques) figures.push_back(figuresOf(s, t));
  return figures;
}

std::string stabilityTable(const nlohmann::json& figures) { return tableText(kColumns, figures); }

void writeStabilityReport(const fs::path& folder, const std::vector<ShotRun>& shots, const nlohmann::json& figures,
                          const std::string& conditions) {
  writeText(folder / "stability.csv", csvText(figures));
  writeText(folder / "stability.md", "# Temporal stability\n\n" + conditions + "\n\n" + stabilityTable(figures));
  writeText(folder / "stability.html", html(shots, figures, conditions));
  for (const ShotRun& s : shots) writeText(folder / ("series-" + s.name + ".csv"), seriesCsv(s));
}

} // namespace lambent
