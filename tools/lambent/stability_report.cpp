#include "tools/lambent/stability_report.h"

#include "gi/plan/techniques.h"
#include "tools/lambent/picture.h"
#include "tools/lambent/plot.h"

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

/// What a technique's |E'| is compared with: ir as in paper 1, among techniques from reflective maps rsm. Null: none.
const TechniqueRun* simplestOf(const ShotRun& shot, const TechniqueRun& t) {
  const char* name = needsOf(techniqueByName(t.name)).reflective() ? "rsm" : "ir";
  const auto simplest = std::ranges::find(shot.techniques, name, &TechniqueRun::name);
  return simplest != shot.techniques.end() ? &*simplest : nullptr;
}

/// What is ranked, as rows of figures name it.
struct Statistic {
  const char *key, *title;
  GroupErrors TechniqueRun::*pixels;
  StatisticRuns GroupErrors::*runs;
  NoisyErrors GroupErrors::*noisy;

  std::string floorKey() const { return std::string(key) + "_floor"; }
  std::string restKey() const { return std::string(key) + "_less_floor"; }
};
constexpr Statistic kStatistics[] = {
    {"error_marked", "|E| marked", &TechniqueRun::marked, &GroupErrors::error, &GroupErrors::noisyError},
    {"change_marked", "|E'| marked", &TechniqueRun::marked, &GroupErrors::change, &GroupErrors::noisyChange},
    {"error_grid", "|E| grid", &TechniqueRun::grid, &GroupErrors::error, &GroupErrors::noisyError},
    {"change_grid", "|E'| grid", &TechniqueRun::grid, &GroupErrors::change, &GroupErrors::noisyChange}};
constexpr const char *kRatio = "change_over_simplest", *kRatioRest = "change_over_simplest_less_floor";

/// Of the shot's techniques. Empty where no pixel is marked: there is nothing to know of them.
std::vector<UncertainValue> estimatesOf(const ShotRun& s, const Statistic& statistic) {
  std::vector<StatisticRuns> all;
  for (const TechniqueRun& t : s.techniques)
    if (s.marked > 0 || statistic.pixels != &TechniqueRun::marked) all.push_back(t.*statistic.pixels.*statistic.runs);
  return estimatesOf(all);
}

/// KEY and KEY_se, as far as they are known.
void put(Value& row, const std::string& key, const UncertainValue& value) {
  if (!std::isnan(value.value)) row[key] = value.value;
  if (!std::isnan(value.value + value.error)) row[key + "_se"] = value.error;
}

Value figuresOf(const ShotRun& s, size_t index) {
  const TechniqueRun& t = s.techniques[index];
  Value row =
      Value::of("shot", s.name, "technique", t.name, "vpls", t.vpls, "protocol", s.protocol, "frames", s.truth.size(),
                "pixels_marked", s.marked, "pixels_grid", s.truth.front().size() - s.marked, "steps", s.steps,
                "error_marked", t.marked.mean.error, "change_marked", t.marked.mean.change, "error_grid",
                t.grid.mean.error, "change_grid", t.grid.mean.change, "bias_grid", t.grid.mean.bias, "l90_median",
                t.latency.median, "l90_worst_tenth", t.latency.worstTenth, "l90_followed", t.latency.followed,
                "l90_count", t.latency.count, "place_ms", t.placeMs, "truth_error", s.truthError);
  for (const Statistic& statistic : kStatistics)
    if (const auto estimates = estimatesOf(s, statistic); !estimates.empty() && !std::isnan(estimates[index].error))
      row[std::string(statistic.key) + "_se"] = estimates[index].error;
  if (t.latency.count > 0) row["l90"] = std::vector{t.latency.median, t.latency.worstTenth, 100 * t.latency.followed};
  const TechniqueRun* simplest = simplestOf(s, t);
  if (simplest && simplest->grid.mean.change > 0) row[kRatio] = t.grid.mean.change / simplest->grid.mean.change;
  for (const Statistic& statistic : kStatistics)
    if (const NoisyErrors& noisy = t.*statistic.pixels.*statistic.noisy; noisy.sum().count > 0) {
      row[statistic.floorKey()] = noisy.floor();
      put(row, statistic.restKey(), withoutNoise(noisy));
    }
  if (simplest && simplest != &t && simplest->grid.noisyChange.sum().count > 0)
    put(row, kRatioRest, ratioWithoutNoise(t.grid.noisyChange, simplest->grid.noisyChange));
  const auto published = kPublished.find(s.name.substr(0, s.name.find("-small")));
  if (t.name == techniqueTable().front().name && published != kPublished.end()) row["paper_1"] = published->second;
  if (!s.still) return row;
  row["error_still_marked"] = t.marked.still;
  row["error_still_grid"] = t.grid.still;
  row["error_over_still"] = std::vector{t.marked.mean.error / t.marked.still, t.grid.mean.error / t.grid.still};
  return row;
}

const std::vector<TableColumn> kColumns{{"shot", "shot"},
                                        {"technique", "technique"},
                                        {"vpls", "N", "%g", 1, "cut"},
                                        {"error_marked", "\\|E\\| marked", "%.4f"},
                                        {"change_marked", "\\|E'\\| marked", "%.4f"},
                                        {"error_grid", "\\|E\\| grid", "%.4f"},
                                        {"change_grid", "\\|E'\\| grid", "%.4f"},
                                        {"bias_grid", "bias", "%+.4f"},
                                        {kRatio, "\\|E'\\| over ir's, rsm's", "%.2f"},
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
  std::vector<double> seconds;
  for (size_t f = 0; f < s.truth.size(); ++f) seconds.push_back(double(f) / s.fps);
  for (size_t p = 0; p < s.marked; ++p) {
    Plot& plot = plots.emplace_back(format("%s, pixel %zu", s.name.c_str(), p), "time, s",
                                    "luminance, tone-mapped (0 to 1)", false);
    const auto add = [&](const std::string& name, const PixelSeries& series, const char* colour) {
      PlotLine& line = plot.lines.emplace_back(name, seconds, std::vector<double>{}, colour);
      for (const auto& frame : series) line.y.push_back(frame[p]);
    };
    for (const TechniqueRun& t : s.techniques) add(t.name, t.series, nullptr);
    add("truth", s.truth, "#000");
  }
  return plots;
}

/// A row for each technique of each shot, for programs and for the tables.
Value stabilityFigures(const std::vector<ShotRun>& shots) {
  Value figures = Value::list();
  for (const ShotRun& s : shots)
    for (size_t t = 0; t < s.techniques.size(); ++t) figures.add(figuresOf(s, t));
  return figures;
}

/// The rows as Markdown.
std::string stabilityTable(const Value& figures) {
  Value rows = figures;
  for (Value& row : rows.items())
    for (const Statistic& statistic : kStatistics)
      if (const std::string error = std::string(statistic.key) + "_se"; row.has(error))
        row[statistic.key] = format("%.4f ± %.4f", row[statistic.key].number(), row[error].number());
  return tableText(kColumns, rows);
}

/// What the truth's noise alone makes of each error, and what is left without it. Empty of an exact truth.
std::string floorTable(const Value& figures) {
  std::vector<TableColumn> columns{kColumns[0], kColumns[1]};
  Value rows = figures;
  bool any = false;
  const auto left = [](const Value& row, const std::string& key, const char* pattern) {
    std::string text = row.has(key) ? format(pattern, row[key].number()) : "?";
    if (row.has(key + "_se")) text += " ± " + format(pattern, row[key + "_se"].number());
    return text;
  };
  for (Value& row : rows.items()) {
    for (const Statistic& s : kStatistics)
      if (row.has(s.floorKey())) {
        row[s.key] = format("%.4f, ", row[s.floorKey()].number()) + left(row, s.restKey(), "%.4f");
        any = true;
      } else {
        row[s.key] = "";
      }
    if (row.has(kRatioRest)) row[kRatio] = left(row, kRatioRest, "%.2f");
  }
  if (!any) return "";
  for (const TableColumn& c : kColumns)
    if (c.key == std::string_view(kRatio) || c.key == std::string_view("paper_1") ||
        std::ranges::find(kStatistics, std::string_view(c.key), &Statistic::key) != std::end(kStatistics))
      columns.push_back(c);
  return "The floor, which is what the truth's noise alone makes of each, and what is left without it:\n\n" +
         tableText(columns, rows);
}

/// A line for each shot and error: who is better than whom, as far as noise lets one tell. Empty of one technique.
std::string stabilityRankings(const std::vector<ShotRun>& shots) {
  std::string text;
  for (const ShotRun& s : shots)
    for (const Statistic& statistic : kStatistics) {
      const std::vector<UncertainValue> estimates = estimatesOf(s, statistic);
      if (estimates.size() < 2) continue;
      std::vector<Ranked> all;
      for (size_t i = 0; i < estimates.size(); ++i) all.push_back({s.techniques[i].name, estimates[i]});
      text += "- " + s.name + ", " + statistic.title + ": " + rankingText(ranked(std::move(all))) + "\n";
    }
  if (text.empty()) return text;
  return "Rankings, the least first; a difference counts where seeds and the truth's noise make it in less than one of "
         "twenty cases:\n\n" +
         text;
}

} // namespace

void checkStabilityResults(const fs::path& folder, const std::string& shot) {
  for (const std::string& name : {std::string("stability.csv"), std::string("stability.md"), "series-" + shot + ".csv",
                                  "series-" + shot + ".svg", "marked-" + shot + ".png"})
    checkWritable(folder / name);
}

void writeStabilityReport(const OutputOptions& output, const fs::path& folder, const std::vector<ShotRun>& shots,
                          const std::string& conditions) {
  const Value figures = stabilityFigures(shots);
  std::string page = conditions + "\n\n" + stabilityTable(figures);
  if (const std::string floors = floorTable(figures); !floors.empty()) page += "\n" + floors;
  if (const std::string rankings = stabilityRankings(shots); !rankings.empty()) page += "\n" + rankings;
  for (const ShotRun& s : shots) {
    writeText(folder / ("series-" + s.name + ".csv"), seriesCsv(s));
    if (s.marked == 0) continue;
    writeShown(folder / ("marked-" + s.name + ".png"), s.image);
    page += "\n![" + s.name + ", first frame, marked pixels](marked-" + s.name + ".png)\n";
    writeText(folder / ("series-" + s.name + ".svg"), svgOf(plotsOf(s), 2));
    page += "\n![" + s.name + ", marked pixels over time](series-" + s.name + ".svg)\n";
  }
  writeReport(output, folder, "stability", "Temporal stability", page, csvText(figures), figures);
}

} // namespace lambent
