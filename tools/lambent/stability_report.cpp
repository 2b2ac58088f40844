#include "tools/lambent/stability_report.h"
#include "tools/lambent/html.h"

#include "gi/plan/techniques.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/plot.h"
#include "tools/lambent/text.h"

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
  const TechniqueRun* simplest = shot.technique(needsOf(settings).reflective() ? "rsm" : "ir");
  return simplest && simplest->grid.change > 0 ? simplest : nullptr;
}

/// What is ranked, as rows of figures name it.
struct Statistic {
  const char *key, *title;
  ErrorRuns TechniqueRun::*pixels;
  StatisticRuns ErrorRuns::*error;
};
constexpr Statistic kStatistics[] = {{"error_marked", "|E| marked", &TechniqueRun::runsMarked, &ErrorRuns::error},
                                     {"change_marked", "|E'| marked", &TechniqueRun::runsMarked, &ErrorRuns::change},
                                     {"error_grid", "|E| grid", &TechniqueRun::runsGrid, &ErrorRuns::error},
                                     {"change_grid", "|E'| grid", &TechniqueRun::runsGrid, &ErrorRuns::change}};

/// Without marked pixels there is nothing to know of them.
bool measured(const ShotRun& s, const Statistic& statistic) {
  return s.marked > 0 || statistic.pixels != &TechniqueRun::runsMarked;
}

/// Beside the shot's techniques.
std::vector<UncertainValue> estimatesOf(const ShotRun& s, const Statistic& statistic) {
  std::vector<StatisticRuns> all;
  for (const TechniqueRun& t : s.techniques) all.push_back(t.*statistic.pixels.*statistic.error);
  return estimatesOf(all);
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
  for (const Statistic& statistic : kStatistics) {
    if (!measured(s, statistic)) continue;
    const double error = estimatesOf(s, statistic)[size_t(&t - s.techniques.data())].error;
    if (!std::isnan(error)) j[std::string(statistic.key) + "_se"] = error;
  }
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

/// Tone-mapped luminance of each marked pixel over time, as paper 1, fig. 7.
std::vector<Plot> plotsOf(const ShotRun& s) {
  std::vector<Plot> plots;
  for (size_t p = 0; p < s.marked; ++p) {
    Plot plot{.title = format("%s, pixel %zu", s.name.c_str(), p),
              .xLabel = "time, s",
              .yLabel = "luminance, tone-mapped (0 to 1)",
              .x = {},
              .even = true,
              .series = {}};
    const auto add = [&](const std::string& name, const PixelSeries& series, const char* colour) {
      plot.series.push_back({name, {}, colour});
      for (const auto& frame : series) plot.series.back().y.push_back(frame[p]);
    };
    for (size_t f = 0; f < s.truth.size(); ++f) plot.x.push_back(double(f) / s.fps);
    for (const TechniqueRun& t : s.techniques) add(t.name, t.series, nullptr);
    add("truth", s.truth, "#000");
    plots.push_back(std::move(plot));
  }
  return plots;
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

std::string stabilityTable(const nlohmann::json& figures) {
  nlohmann::json rows = figures;
  for (nlohmann::json& row : rows)
    for (const Statistic& statistic : kStatistics)
      if (const std::string error = std::string(statistic.key) + "_se"; row.contains(error))
        row[statistic.key] = format("%.4f ± %.4f", row[statistic.key].get<double>(), row[error].get<double>());
  return tableText(kColumns, rows);
}

std::string stabilityRankings(const std::vector<ShotRun>& shots) {
  std::string text;
  for (const ShotRun& s : shots) {
    if (s.techniques.size() < 2) continue;
    for (const Statistic& statistic : kStatistics) {
      if (!measured(s, statistic)) continue;
      const std::vector<UncertainValue> estimates = estimatesOf(s, statistic);
      std::vector<Ranked> all;
      for (size_t i = 0; i < estimates.size(); ++i) all.push_back({s.techniques[i].name, estimates[i]});
      text += "- " + s.name + ", " + statistic.title + ": " + rankingText(ranked(std::move(all))) + "\n";
    }
  }
  if (text.empty()) return text;
  return "Rankings, the least first; a difference counts where seeds and the truth's noise make it in less than one of "
         "twenty cases:\n\n" +
         text;
}

void writeStabilityReport(const fs::path& folder, const std::vector<ShotRun>& shots, const nlohmann::json& figures,
                          const std::string& conditions) {
  writeText(folder / "stability.csv", csvText(figures));
  std::string page = "# Temporal stability\n\n" + conditions + "\n\n" + stabilityTable(figures);
  if (const std::string rankings = stabilityRankings(shots); !rankings.empty()) page += "\n" + rankings;
  for (const ShotRun& s : shots) {
    writeText(folder / ("series-" + s.name + ".csv"), seriesCsv(s));
    if (s.marked == 0) continue;
    writeShown(folder / ("marked-" + s.name + ".png"), s.picture);
    page += "\n![" + s.name + ", first frame, marked pixels](marked-" + s.name + ".png)\n";
    writeText(folder / ("series-" + s.name + ".svg"), svgOf(plotsOf(s), 2));
    page += "\n![" + s.name + ", marked pixels over time](series-" + s.name + ".svg)\n";
  }
  writeText(folder / "stability.md", escaped(page)); // names of files may look like HTML
}

} // namespace lambent
