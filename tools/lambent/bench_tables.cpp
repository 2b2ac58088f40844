// lambent bench --table2 SHOT...: paper 1's table 2, where the time of a sequence goes. The paper's steps are ours as
// columns() says; what we do beyond the paper has a column of its own.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/scaled_view.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/html.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// A column of the table: the stages of ours that it sums, or whether it sums columns before it.
struct Column {
  const char *key, *title;
  std::vector<StageId> stages;
};
/// Paper 1's "generating candidate VPLs, detecting undersampled regions and replacing invalidated VPLs" is three stages
/// here; its G-buffer is part of the shading. Stages of other techniques count where their like does.
const std::vector<Column>& sampling() {
  using enum StageId;
  static const std::vector<Column> columns{
      {"candidates", "candidates", {Points, Candidates, Replace, Photons, Chains}},
      {"resampling", "resampling", {Resample}},
      {"visibility", "indirect visibility", {Validate}},
      {"radiosity", "radiosity", {Radiosity}},
      {"density", "density", {Density}},
  };
  return columns;
}
const std::vector<Column>& rendering() {
  using enum StageId;
  static const std::vector<Column> columns{
      {"maps", "shadow maps", {VplMaps, MapComparison}},
      {"shading",
       "interleaved shading",
       {Surfaces, Vpls, Gather, GatherByRays, IrradianceUpload, Patches, Stencil, Refine, Splat, SplatPerVpl, Upsample,
        Filter}},
      {"beyond", "beyond the paper", {MapChecks, NearLight, History}},
  };
  return columns;
}

double msOf(const FrameStats& s, const std::vector<Column>& columns) {
  double ms = 0;
  for (const Column& c : columns)
    for (StageId stage : c.stages) ms += s.ms(stage);
  return ms;
}

/// All columns with times, in order, totals where the paper has them. The rest of the frame is direct light, the
/// scene's own upkeep and what puts the picture together.
struct Timed {
  const char *key, *title;
  std::function<double(const FrameStats&)> ms;
};
const std::vector<Timed>& columns() {
  static const std::vector<Timed> all = [] {
    std::vector<Timed> out;
    const auto add = [&](const std::vector<Column>& columns, const char* key, const char* title) {
      for (const Column& c : columns)
        out.push_back({c.key, c.title, [&c](const FrameStats& s) { return msOf(s, {c}); }});
      out.push_back({key, title, [&columns](const FrameStats& s) { return msOf(s, columns); }});
    };
    add(sampling(), "sampling_total", "sampling, total");
    add(rendering(), "rendering_total", "rendering, total");
    const auto indirect = [](const FrameStats& s) { return msOf(s, sampling()) + msOf(s, rendering()); };
    out.push_back({"indirect_total", "indirect, total", indirect});
    out.push_back({"rest", "rest", [indirect](const FrameStats& s) { return s.wallMs - indirect(s); }});
    out.push_back({"frame", "frame", [](const FrameStats& s) { return s.wallMs; }});
    return out;
  }();
  return all;
}

/// Paper 1, table 2: thousands of triangles, VPLs, milliseconds at 1920 × 1080 on a GTX Titan X and an i7 4820K. There
/// the indirect total is all, since the rest is not given.
struct Published {
  const char *shot, *name; // of ours that follows it; theirs
  double triangles, vpls, ms[11];
};
constexpr const char* kTable2Keys[] = {"candidates", "resampling",      "visibility",    "radiosity",
                                       "density",    "sampling_total",  "maps",          "shading",
                                       "beyond",     "rendering_total", "indirect_total"};
constexpr Published kTable2[] = {
    {"citadel", "Epic Citadel", 373e3, 2048, {3.3, 3.0, 1.6, 11.0, 2.6, 21.5, 8.7, 20.0, 0, 28.7, 50.2}},
    {"office", "Soda Hall", 551e3, 2048, {2.3, 2.2, 1.2, 7.8, 1.7, 15.2, 15.9, 19.1, 0, 35.0, 50.2}},
    {"atrium", "Crytek Sponza", 262e3, 2048, {2.7, 2.5, 2.0, 9.8, 1.6, 18.6, 6.0, 24.4, 0, 30.4, 49.0}},
    {"maze", "Maze", 471e3, 512, {2.2, 1.6, 1.1, 6.8, 1.6, 13.3, 11.7, 10.5, 0, 22.2, 35.5}},
};
/// The row of the sequence that a shot of ours follows, small versions too; null: none.
const Published* publishedOf(const std::string& shot) {
  for (const Published& p : kTable2)
    if (shot == p.shot || shot.starts_with(std::string(p.shot) + "-")) return &p;
  return nullptr;
}

nlohmann::json rowOf(const Published& p) {
  nlohmann::json row{{"triangles", p.triangles}, {"vpls", p.vpls}};
  for (size_t i = 0; i < std::size(kTable2Keys); ++i) row["median_ms"][kTable2Keys[i]] = p.ms[i];
  return row;
}

nlohmann::json rowOf(const BenchOptions& options, const std::string& file) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  const auto stage = openLaunch(launch);
  if (!stage->shot) throw InputError(file, "not a shot (a .json file)");
  if (!needsOf(stage->settings).sampled())
    throw InputError("--technique " + launch.technique, "has no sampled lights (smc, ir, mir and tcas have)");
  if (stage->settings.frame.overlap)
    throw InputError("setting frame.overlap", "cannot be on here (what runs beside a frame is no part of its time)");
  say(*stage, options.output.quiet);
  const std::string name = fs::path(file).stem().string();
  Progress progress(name, options.output.quiet);
  RunPlan plan = benchPlan(options, *stage, progress);
  size_t triangles = 0;
  plan.view = [&, posed = plan.view](int frame) {
    const SceneView view = posed(frame);
    triangles = trianglesOf(view);
    return view;
  };
  const Measured m = measure({{name, stage->settings, stage->seed}}, plan)[0];
  nlohmann::json row{{"shot", name},
                     {"triangles", triangles},
                     {"vpls", stage->settings.smc.vpls},
                     {"size", {stage->camera.width, stage->camera.height}},
                     {"frames", m.frames.size()}};
  for (const Timed& column : columns()) {
    const Spread s = m.of(column.ms);
    row["median_ms"][column.key] = s.median;
    row["quartiles_ms"][column.key] = {s.quarter, s.threeQuarters};
  }
  if (const Published* p = publishedOf(name)) row["paper_1"] = rowOf(*p);
  return row;
}

/// What is shown of a row, ours or the paper's.
nlohmann::json cellsOf(const std::string& name, const nlohmann::json& row) {
  nlohmann::json cells{{"shot", name}, {"triangles", row["triangles"]}, {"vpls", row["vpls"]}};
  for (const Timed& column : columns()) {
    if (!row["median_ms"].contains(column.key)) continue;
    const double median = row["median_ms"][column.key];
    if (row.contains("quartiles_ms")) {
      const nlohmann::json& q = row["quartiles_ms"][column.key];
      cells[column.key] = spreadText({.median = median, .quarter = q[0], .threeQuarters = q[1]});
    } else {
      cells[column.key] = format("%.1f", median);
    }
  }
  return cells;
}

std::string tableOf(const nlohmann::json& rows) {
  std::vector<TableColumn> titles{{"shot", "ms"}, {"triangles", "triangles", "%.0f"}, {"vpls", "N"}};
  for (const Timed& column : columns()) titles.push_back({column.key, column.title});
  nlohmann::json lines = nlohmann::json::array();
  for (const nlohmann::json& row : rows) {
    lines.push_back(cellsOf(row["shot"], row));
    if (row.contains("paper_1"))
      lines.push_back(cellsOf(std::string("paper 1: ") + publishedOf(row["shot"])->name, row["paper_1"]));
  }
  return tableText(titles, lines);
}

std::string csvOf(const nlohmann::json& rows) {
  nlohmann::json flat = nlohmann::json::array();
  for (const nlohmann::json& row : rows) {
    nlohmann::json& line = flat.emplace_back(
        nlohmann::json{{"shot", row["shot"]}, {"triangles", row["triangles"]}, {"vpls", row["vpls"]}});
    for (const Timed& column : columns()) {
      const std::string key = column.key;
      line[key + "_ms"] = row["median_ms"][key];
      line[key + "_ms_quarter"] = row["quartiles_ms"][key][0];
      line[key + "_ms_three_quarters"] = row["quartiles_ms"][key][1];
      if (row.contains("paper_1") && row["paper_1"]["median_ms"].contains(key))
        line[key + "_ms_paper_1"] = row["paper_1"]["median_ms"][key];
    }
  }
  return csvText(flat);
}

/// Which stages each column sums.
std::string mappingText() {
  std::string text;
  for (const std::vector<Column>* half : {&sampling(), &rendering()})
    for (const Column& c : *half) {
      text += std::string(text.empty() ? "" : "; ") + c.title + " = ";
      for (StageId stage : c.stages)
        text += std::string(stage == c.stages[0] ? "" : " + ") + kStageNames[size_t(stage)];
    }
  return "Stages: " + text + "; rest = all else of the frame.";
}

} // namespace

void benchTable2(const BenchOptions& options) {
  for (const std::string& file : options.scenes) // before minutes are spent on those before it
    if (!fs::exists(file)) throw InputError(file, "no such file");
  const fs::path folder = reportFolder(options.output.out, "out/bench");
  const GlContext context = GlContext::headless();
  nlohmann::json rows;
  for (const std::string& file : options.scenes) rows.push_back(rowOf(options, file));
  const std::string machine = machineText(context);
  writeJson(options.output.json, {{"machine", machine}, {"rows", rows}});
  const std::string conditions =
      std::to_string(rows[0]["size"][0].get<int>()) + " x " + std::to_string(rows[0]["size"][1].get<int>()) + ", " +
      std::to_string(rows[0]["frames"].get<size_t>()) + " frames of the first shot, " + machine +
      "; medians (quartiles) in ms; medians of totals are not totals of medians. Paper 1: 1920 x 1080, GTX Titan X.\n" +
      mappingText() + "\n";
  const std::string table = tableOf(rows);
  writeText(folder / "table2.md", escaped("# Where the time of sequences goes\n\n" + conditions + "\n" + table));
  writeText(folder / "table2.csv", csvOf(rows));
  if (!options.output.quiet)
    std::printf("%s%sreport: %s\n", conditions.c_str(), table.c_str(), (folder / "table2.md").c_str());
}

} // namespace lambent
