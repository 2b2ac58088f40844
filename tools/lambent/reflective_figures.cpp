// lambent accuracy SCENE --figure 2.N, 3.N, criterion, upsampling: what papers 2 and 3 draw of light from reflective
// shadow maps, each figure a row of the table below. Their figs. 9 and 13 of paper 3 are --curve, its table 1 is
// `bench --multires`.
#include "tools/lambent/reflective_figures.h"
#include "gi/measure/scaled_view.h"

#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/plot.h"
#include "tools/lambent/reflective_truth.h"
#include "tools/lambent/study.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// A setting and its values, ascending.
struct Axis {
  std::string setting = {}; // empty: none
  std::vector<std::string> values = {""};
};

/// A picture that is kept. Of indirect light: measured too.
struct Named {
  const char* name;
  Assignments assignments;
  const char* technique = nullptr; // null: each of the figure's
  Buffer buffer = Buffer::Indirect;
};

/// What errors are measured against: nothing, the same VPLs at every pixel, or every texel of the maps at every pixel.
enum class Truth { None, Pixels, Texels };

/// What is plotted over PaperFigure::x, a line for each value of PaperFigure::series.
struct Curve {
  const char *key, *label;
  double factor = 1;
};
const Curve kRate{"fps", "frames per second"}, kPatches{"patches", "patches, thousands", 1e-3},
    kError{"rmse_share", "RMSE, % of mean indirect radiance", 100}, kLights{"vpls", "VPLs"};

struct PaperFigure {
  const char *name, *title;
  std::vector<std::string> techniques;
  Axis x = {}, series = {}; // each technique with each value of both
  std::vector<Named> pictures = {};
  Truth truth = Truth::Pixels;
  std::vector<Curve> curves = {kRate};
  bool overTime = false; // of the shot, and its frames are the rows
};

const std::vector<PaperFigure>& figures() {
  const std::vector<std::string> both{"multires-splat", "multires-gather"}, gather{"multires-gather"};
  const Assignments papers{{"multires.criterion", "depth"},
                           {"multires.balance", "off"},
                           {"multires.edges", "off"},
                           {"multires.upsample", "bilinear"}};
  const auto with = [](Assignments all, const char* name, const char* value) {
    all.emplace_back(name, value);
    return all;
  };
  static const std::vector<PaperFigure> table{
      {.name = "2.table-1",
       .title = "frame rate by the size of the finest patches",
       .techniques = both,
       .x = {"multires.finest", {"1", "2", "4", "8"}}},
      {.name = "2.7",
       .title = "detail and frame rate by the threshold of normals, and detail put back (multires.detail)",
       .techniques = both,
       .x = {"multires.normal", {"0.05", "0.1", "0.25", "0.5", "1", "1.4", "2"}},
       .pictures = {{"normal-0.25", {{"multires.normal", "0.25"}}, "multires-gather"},
                    {"normal-1.4", {{"multires.normal", "1.4"}}, "multires-gather"},
                    {"normal-1.4-detail", {{"multires.normal", "1.4"}, {"multires.detail", "0.5"}}, "multires-gather"},
                    {"patches-0.25", {{"multires.normal", "0.25"}}, "multires-gather", Buffer::Patches},
                    {"patches-1.4", {{"multires.normal", "1.4"}}, "multires-gather", Buffer::Patches}},
       .curves = {kRate, kPatches, kError}},
      {.name = "2.8",
       .title = "frame rate by the number of VPLs and the size of the finest patches",
       .techniques = both,
       .x = {"rsm.vpls", {"64", "144", "256", "576", "1024"}},
       .series = {"multires.finest", {"1", "2", "4", "8", "16", "32"}},
       .truth = Truth::None},
      {.name = "2.9",
       .title = "indirect light with little and with much refinement, and with detail put back",
       .techniques = both,
       .pictures = {{"normal-0.2", {{"multires.normal", "0.2"}}},
                    {"normal-1.5", {{"multires.normal", "1.5"}}},
                    {"normal-1.5-detail", {{"multires.normal", "1.5"}, {"multires.detail", "0.5"}}},
                    {"direct", {}, "multires-gather", Buffer::Direct}}},
      {.name = "3.10",
       .title = "frame rate and number of VPLs while the shot's lights move",
       .techniques = {"multires-gather", "isr", "hisr"},
       .truth = Truth::None,
       .curves = {kRate, kLights},
       .overTime = true},
      {.name = "3.11",
       .title = "isr: frame rate by the threshold of depths in the maps and the finest clusters to begin with",
       .techniques = {"isr"},
       .x = {"rsm.depth", {"0.01", "0.02", "0.05", "0.1", "0.2", "0.5"}},
       .series = {"rsm.finest", {"64", "128", "256"}},
       .truth = Truth::Texels,
       .curves = {kRate, kLights, kError}},
      {.name = "3.12",
       .title = "hisr: frame rate by the bound of a cluster's light and how deep trees are walked",
       .techniques = {"hisr"},
       .x = {"rsm.tau", {"0.001", "0.002", "0.004", "0.01", "0.03", "0.1"}},
       .series = {"rsm.finest", {"64", "128", "256"}},
       .truth = Truth::Texels,
       .curves = {kRate, kError}},
      {.name = "3.combined",
       .title = "error of patches, of clusters, and of both, against every texel of the maps at every pixel",
       .techniques = {},
       .pictures = {{"patches", {{"rsm.finest", "1024"}, {"rsm.depth", "0"}}, "isr"},
                    {"isr-clusters", {{"gather.mode", "full"}}, "isr"},
                    {"hisr-clusters", {{"gather.mode", "full"}}, "hisr"},
                    {"isr-both", {}, "isr"},
                    {"hisr-both", {}, "hisr"}},
       .truth = Truth::Texels},
      {.name = "criterion",
       .title = "patches split by distance from their plane, or by their range of depths (papers 2 and 3)",
       .techniques = gather,
       .x = {"multires.depth", {"0.005", "0.01", "0.02", "0.05", "0.1", "0.2", "0.5"}},
       .series = {"multires.criterion", {"plane", "depth"}},
       .pictures = {{"plane", {{"multires.criterion", "plane"}}},
                    {"depth", {{"multires.criterion", "depth"}}},
                    {"plane-patches", {{"multires.criterion", "plane"}}, "multires-gather", Buffer::Patches},
                    {"depth-patches", {{"multires.criterion", "depth"}}, "multires-gather", Buffer::Patches}},
       .curves = {kPatches, kError, kRate}},
      {.name = "upsampling",
       .title = "between patches: by how alike surfaces are, or bilinear (papers 2 and 3); papers: their criterion, "
                "neither balance nor edges",
       .techniques = gather,
       .pictures = {{"bilateral", {{"multires.upsample", "bilateral"}}},
                    {"bilinear", {{"multires.upsample", "bilinear"}}},
                    {"papers", papers},
                    {"papers-but-bilateral", with(papers, "multires.upsample", "bilateral")}}},
  };
  return table;
}

/// A row of the report.
struct Row {
  std::string technique, picture, series, x; // those that it has
  Assignments assignments;
};

Variant variantOf(const LaunchContext& stage, const std::string& technique, const Assignments& assignments) {
  Variant v{technique, stage.settings, stage.seed};
  applyTechnique(v.settings, technique);
  for (const auto& [name, value] : assignments) applySetting(v.settings, name, value);
  return v;
}

std::vector<Row> rowsOf(const PaperFigure& figure, bool quick) {
  const auto values = [quick](const Axis& axis) {
    std::vector<std::string> some{axis.values.front(), axis.values.back()};
    return quick && axis.values.size() > 2 ? some : axis.values;
  };
  std::vector<Row> rows;
  for (const std::string& technique : figure.techniques)
    for (const std::string& series : values(figure.series))
      for (const std::string& x : values(figure.x)) {
        if (figure.x.setting.empty() && !figure.overTime) continue;
        Row& row = rows.emplace_back(technique, "", series, x);
        if (!series.empty()) row.assignments.emplace_back(figure.series.setting, series);
        if (!x.empty()) row.assignments.emplace_back(figure.x.setting, x);
      }
  for (const Named& n : figure.pictures)
    if (n.buffer == Buffer::Indirect)
      for (const std::string& technique : n.technique ? std::vector<std::string>{n.technique} : figure.techniques)
        rows.emplace_back(technique, n.name, "", "", n.assignments);
  return rows;
}

/// Median times of a row's frames, and what they worked on.
nlohmann::json figuresOf(const Measured& m) {
  using enum StageId;
  const auto ms = [&m](std::initializer_list<StageId> stages) {
    return m
        .of([&](const FrameStats& s) {
          double sum = 0;
          for (StageId stage : stages) sum += s.ms(stage);
          return sum;
        })
        .median;
  };
  const double frame = m.of([](const FrameStats& s) { return s.wallMs; }).median;
  return {{"maps_ms", ms({ReflectiveMaps, ReflectiveLights, LightPatches})},
          {"pyramid_ms", ms({Patches})},
          {"refine_ms", ms({Stencil, Refine})},
          {"light_ms", ms({Gather, Splat})},
          {"upsample_ms", ms({Upsample})},
          {"frame_ms", frame},
          {"fps", 1000 / frame},
          {"patches", m.frames.back().patches},
          {"vpls", m.frames.back().vplsAlive}};
}

const char* xLabel(const PaperFigure& figure) { return figure.overTime ? "seconds" : figure.x.setting.c_str(); }

/// One plot for each technique and curve, with a line for each value of the series.
std::vector<Plot> plotsOf(const PaperFigure& figure, const nlohmann::json& rows) {
  std::vector<Plot> plots;
  for (const std::string& technique : figure.techniques)
    for (const Curve& curve : figure.curves) {
      Plot plot{technique, xLabel(figure), curve.label, {}, {}, figure.overTime, {}, {}};
      for (const nlohmann::json& row : rows) {
        if (row["technique"] != technique || !row.contains("x") || !row.contains(curve.key)) continue;
        const double x = row["x"];
        const std::string series = row.value("series", technique);
        if (plot.series.empty() || plot.series.back().name != series) plot.series.push_back({series, {}});
        if (plot.series.size() == 1) plot.x.push_back(x);
        plot.series.back().y.push_back(curve.factor * row[curve.key].get<double>());
      }
      if (!figure.series.setting.empty())
        for (PlotSeries& s : plot.series) s.name = figure.series.setting + " " + s.name;
      // Patches are counted where they gather, and hisr's clusters are not: nothing to see of those.
      const bool any = std::ranges::any_of(
          plot.series, [](const PlotSeries& s) { return std::ranges::any_of(s.y, [](double y) { return y != 0; }); });
      if (any) plots.push_back(std::move(plot));
    }
  return plots;
}

std::string tableOf(const PaperFigure& figure, const nlohmann::json& rows) {
  const auto has = [&](const char* key) {
    return std::ranges::any_of(rows, [&](const nlohmann::json& row) { return row.contains(key); });
  };
  std::vector<TableColumn> columns{{"technique", "technique"}};
  if (has("picture")) columns.push_back({"picture", "picture"});
  if (has("series")) columns.push_back({"series", figure.series.setting.c_str()});
  if (has("x")) columns.push_back({"x", xLabel(figure)});
  if (has("rmse_share")) {
    columns.push_back({"rmse_share", "RMSE, % mean", "%.2f", 100});
    columns.push_back({"rms_shown", "RMS shown, %", "%.2f", 100});
    columns.push_back({"bias", "bias, %", "%+.2f", 100});
  }
  columns.push_back({"vpls", "VPLs", "%g", 1, "a cut"});
  columns.push_back({"patches", "patches", "%.0f", 1, ""});
  for (const auto& [key, title] : {std::pair("maps_ms", "maps, ms"),
                                   {"pyramid_ms", "pyramid"},
                                   {"refine_ms", "refine"},
                                   {"light_ms", "light"},
                                   {"upsample_ms", "upsample"},
                                   {"frame_ms", "frame, ms"}})
    columns.push_back({key, title, "%.1f"});
  columns.push_back({"fps", "fps", "%.2f"});
  return tableText(columns, rows);
}

/// What errors are measured against.
struct Baseline {
  Image picture, shown;
  float exposure;
};

std::optional<Baseline> baselineOf(const PaperFigure& figure, const LaunchContext& stage, const RunPlan& plan) {
  if (figure.truth == Truth::None) return {};
  Variant every = variantOf(stage, "rsm", {{"gather.mode", "full"}});
  if (figure.truth == Truth::Texels) lightByEveryTexel(every.settings);
  const Measured m = measure({every}, plan)[0];
  return Baseline{m.picture, shownImage(m.picture, m.exposure), m.exposure};
}

} // namespace

std::vector<std::string> reflectiveFigureNames() {
  std::vector<std::string> names;
  for (const PaperFigure& f : figures()) names.push_back(f.name);
  return names;
}

void reflectiveFigure(const AccuracyOptions& options) {
  const PaperFigure& figure = *std::ranges::find(figures(), options.figure, &PaperFigure::name);
  LaunchOptions launch = options.launch;
  if (launch.size.empty()) launch.size = options.quick ? "48x27" : "512x512";
  if (options.quick) launch.set.insert(launch.set.begin(), {"rsm.resolution=32", "rsm.coarsest=8"});
  const auto stage = openLaunch(launch);
  needPunctualLight(*stage);
  if (figure.overTime && !stage->shot) throw InputError(launch.scene, "not a shot (a .json file, with moving lights)");
  say(*stage, options.output.quiet);
  const fs::path folder = reportFolder(options.output.out, format("out/figure-%s", figure.name));
  GlContext context = GlContext::headless();
  Progress progress("drawing", options.output.quiet);
  stage->settings.effects[EffectId::Redraw] = EffectMode::On;
  RunPlan plan = stillPlan(*stage, progress, Buffer::Indirect);
  const std::optional<Baseline> baseline = baselineOf(figure, *stage, plan);
  if (baseline && !(pictureError(baseline->picture, baseline->picture).meanTruth > 0))
    throw InputError(launch.scene, "no light of reflective shadow maps reaches this view (another view or --point)");

  std::vector<LightView> lights;
  if (figure.overTime) {
    plan = planOf(*stage, progress, options.quick ? 4 : 0);
  } else { // lights waver, so that every stage runs in every frame; in the last they are where the baseline has them
    plan.view = [&](int frame) { return unsteady(stage->at(0), frame, lights); };
    plan.frames = options.quick ? 3 : 5;
  }
  plan.skip = 1;
  const std::vector<Row> rows = rowsOf(figure, options.quick);
  std::vector<Variant> variants;
  for (const Row& row : rows) variants.push_back(variantOf(*stage, row.technique, row.assignments));
  const std::vector<Measured> runs = measure(variants, plan);

  if (baseline) writeShown(folder / "baseline.png", baseline->shown);
  nlohmann::json report = nlohmann::json::array(), printed = report; // over time a line each is printed, of medians
  for (size_t i = 0; i < runs.size(); ++i) {
    const Row& row = rows[i];
    const Measured& m = runs[i];
    nlohmann::json j{{"technique", row.technique}};
    if (!row.picture.empty()) j["picture"] = row.picture;
    if (!row.series.empty()) j["series"] = row.series;
    if (!row.x.empty()) j["x"] = std::stod(row.x);
    for (size_t f = 0; figure.overTime && f < m.frames.size(); ++f) {
      report.push_back(j);
      report.back().update(figuresOf({.variant = m.variant, .frames = {m.frames[f]}}));
      report.back()["x"] = double(f + size_t(plan.skip)) / stage->shot->fps;
    }
    j.update(figuresOf(m));
    if (baseline) {
      const PictureError error = pictureError(m.picture, baseline->picture);
      const Image shown = shownImage(m.picture, baseline->exposure);
      j["rmse_share"] = error.rmseShare();
      j["rms_shown"] = pictureError(shown, baseline->shown).rmse;
      j["bias"] = error.bias;
      if (!row.picture.empty()) { // splatted or gathered: the same one
        writeShown(folder / (row.picture + ".png"), shown);
        writeShown(folder / (row.picture + "-difference.png"), absoluteDifference(shown, baseline->shown, 8));
      }
    }
    printed.push_back(j);
    if (!figure.overTime) report.push_back(j);
  }
  for (const Named& n : figure.pictures) {
    if (n.buffer == Buffer::Indirect) continue;
    Viewer gi(variantOf(*stage, n.technique, n.assignments).settings, stage->seed);
    gi.run(stage->at(0));
    writeBuffer(folder / (std::string(n.name) + ".png"), gi, n.buffer);
  }
  writeText(folder / "figure.csv", csvText(report));
  const std::vector<Plot> plots = plotsOf(figure, report);
  if (!plots.empty()) writeText(folder / "figure.svg", svgOf(plots, 3));
  writeJson(options.output.json, {{"figure", figure.name}, {"rows", report}});
  if (!options.output.quiet)
    std::printf("%s, %d x %d\n\n%s\nreport (differences times 8): %s\n", figure.title, stage->camera.width,
                stage->camera.height, tableOf(figure, printed).c_str(), folder.c_str());
}

} // namespace lambent
