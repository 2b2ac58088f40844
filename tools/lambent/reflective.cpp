// lambent accuracy SCENE --figure 2.N, 3.N, criterion, upsampling, and --curve patches, clusters: what papers 2 and 3
// draw of light from reflective shadow maps. Figures are rows of a table; curves are paper 3's figs. 9 and 13, error
// against threshold. Table 1 of paper 3 is `bench --multires`.
#include "engine/core/error.h"
#include "gi/measure/scaled_view.h"
#include "gi/plan/techniques.h"
#include "tools/lambent/accuracy.h"
#include "tools/lambent/picture.h"
#include "tools/lambent/plot.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// A setting and its values, ascending.
struct FigureAxis {
  std::string setting = {}; // empty: none
  std::vector<std::string> values = {""};
};

/// A picture that is kept. Of indirect light: measured too.
struct FigurePicture {
  const char* name;
  Assignments set;
  const char* technique = nullptr; // null: each of the figure's
  Buffer buffer = Buffer::Indirect;
};

/// What errors are measured against: nothing, the same VPLs at every pixel, or every texel of the maps at every pixel.
enum class FigureTruth { None, Pixels, Texels };

/// What is plotted over PaperFigure::x, a line for each value of PaperFigure::series.
struct FigureCurve {
  const char *key, *label;
  double factor = 1;
};
constexpr FigureCurve kRate{"fps", "frames per second"}, kPatches{"patches", "patches, thousands", 1e-3},
    kError{"rmse_share", "RMSE, % of mean indirect radiance", 100}, kLights{"vpls", "VPLs"};

struct PaperFigure {
  const char *name, *title;
  std::vector<std::string> techniques;
  FigureAxis x = {}, series = {}; // each technique with each value of both
  std::vector<FigurePicture> pictures = {};
  FigureTruth truth = FigureTruth::Pixels;
  std::vector<FigureCurve> curves = {kRate};
  bool overTime = false; // of the shot, and its frames are the rows
};

const std::vector<PaperFigure>& paperFigures() {
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
       .truth = FigureTruth::None},
      {.name = "2.9",
       .title = "indirect light with little and with much refinement, and with detail put back",
       .techniques = both,
       .pictures = {{"normal-0.2", {{"multires.normal", "0.2"}}},
                    {"normal-1.5", {{"multires.normal", "1.5"}}},
                    {"normal-1.5-detail", {{"multires.normal", "1.5"}, {"multires.detail", "0.5"}}},
                    {"direct", {}, "multires-gather", Buffer::Direct}}},
      {.name = "2.6",
       .title = "glossy surfaces, whose patches are split for each VPL by what it brings",
       .techniques = {},
       .pictures = {{"glossy", {{"gather.mode", "splat-per-vpl"}, {"gather.glossy", "on"}}, "multires-splat"},
                    {"matte", {{"gather.mode", "splat-per-vpl"}}, "multires-splat"},
                    {"glossy-direct", {{"gather.glossy", "on"}}, "multires-splat", Buffer::Direct},
                    {"glossy-beauty",
                     {{"gather.mode", "splat-per-vpl"}, {"gather.glossy", "on"}},
                     "multires-splat",
                     Buffer::Beauty}}},
      {.name = "3.8",
       .title = "four techniques: clusters of lights, patches gathered, every pixel, patches splatted",
       .techniques = {},
       .pictures = {{"hisr", {}, "hisr"},
                    {"multires-gather", {}, "multires-gather"},
                    {"rsm", {}, "rsm"},
                    {"multires-splat", {}, "multires-splat"}},
       .truth = FigureTruth::Texels},
      {.name = "3.10",
       .title = "frame rate and number of VPLs while the shot's lights move",
       .techniques = {"multires-gather", "isr", "hisr"},
       .truth = FigureTruth::None,
       .curves = {kRate, kLights},
       .overTime = true},
      {.name = "3.11",
       .title = "isr: frame rate by the threshold of depths in the maps and the finest clusters to begin with",
       .techniques = {"isr"},
       .x = {"rsm.depth", {"0.01", "0.02", "0.05", "0.1", "0.2", "0.5"}},
       .series = {"rsm.finest", {"64", "128", "256"}},
       .truth = FigureTruth::Texels,
       .curves = {kRate, kLights, kError}},
      {.name = "3.12",
       .title = "hisr: frame rate by the bound of a cluster's light and how deep trees are walked",
       .techniques = {"hisr"},
       .x = {"rsm.tau", {"0.001", "0.002", "0.004", "0.01", "0.03", "0.1"}},
       .series = {"rsm.finest", {"64", "128", "256"}},
       .truth = FigureTruth::Texels,
       .curves = {kRate, kError}},
      {.name = "3.combined",
       .title = "error of patches, of clusters, and of both, against every texel of the maps at every pixel",
       .techniques = {},
       .pictures = {{"patches", {{"rsm.finest", "1024"}, {"rsm.depth", "0"}}, "isr"},
                    {"isr-clusters", {{"gather.mode", "full"}}, "isr"},
                    {"hisr-clusters", {{"gather.mode", "full"}}, "hisr"},
                    {"isr-both", {}, "isr"},
                    {"hisr-both", {}, "hisr"}},
       .truth = FigureTruth::Texels},
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

/// What errors are measured against.
struct Baseline {
  Image picture, shown;
  float exposure = 1;
};

/// Every texel of the maps at every pixel, or the same VPLs at every pixel. Kept as FILE in the folder.
Baseline baselineOf(const Study& study, bool texels, const fs::path& file) {
  Variant every = study.variant("truth", {{"gather.mode", "full"}}, "rsm");
  if (texels) lightByEveryTexel(every.settings);
  const Measured m = study.draw({every}, Buffer::Indirect)[0];
  if (!(imageError(m.image, m.image).meanTruth > 0))
    throw InputError(study.launch.scene,
                     "no light of reflective shadow maps reaches this view (another view or --point)");
  const Image shown = shownImage(m.image, m.exposure);
  writeShown(file, shown);
  return {m.image, shown, m.exposure};
}

/// Errors of the picture as radiance and as it is shown, which is given back.
Image addErrors(Value& row, const Image& picture, const Baseline& baseline) {
  const ImageError error = imageError(picture, baseline.picture);
  Image shown = shownImage(picture, baseline.exposure);
  row["rmse_share"] = error.rmseShare(); // of the truth's mean indirect radiance
  row["rms_shown"] = imageError(shown, baseline.shown).rmse;
  row["bias"] = error.bias;
  return shown;
}

/// A row of a figure's report.
struct Row {
  std::string technique, picture, series, x; // those that it has
  Assignments set = {};
};

std::vector<Row> rowsOf(const PaperFigure& figure, bool quick) {
  const auto values = [quick](const FigureAxis& axis) {
    std::vector<std::string> some{axis.values.front(), axis.values.back()};
    return quick && axis.values.size() > 2 ? some : axis.values;
  };
  std::vector<Row> rows;
  for (const std::string& technique : figure.techniques)
    for (const std::string& series : values(figure.series))
      for (const std::string& x : values(figure.x)) {
        if (figure.x.setting.empty() && !figure.overTime) continue;
        Row& row = rows.emplace_back(technique, "", series, x);
        if (!series.empty()) row.set.emplace_back(figure.series.setting, series);
        if (!x.empty()) row.set.emplace_back(figure.x.setting, x);
      }
  for (const FigurePicture& n : figure.pictures)
    if (n.buffer == Buffer::Indirect)
      for (const std::string& technique : n.technique ? std::vector<std::string>{n.technique} : figure.techniques)
        rows.emplace_back(technique, n.name, "", "", n.set);
  return rows;
}

/// Median times of a row's frames, and what they worked on.
const std::vector<Column>& timeColumns() {
  using enum StageId;
  static const std::vector<Column> columns{
      {{"vpls", "VPLs", "%g", 1, "a cut"}, [](const Outcome& o) -> Value { return o.run.frames.back().vplsAlive; }},
      {{"patches", "patches", "%.0f", 1, ""}, [](const Outcome& o) -> Value { return o.run.frames.back().patches; }},
      {{"maps_ms", "maps, ms", "%.1f"},
       [](const Outcome& o) -> Value {
         return msOf(o.run, {ReflectiveMaps, ReflectiveLights, LightPatches});
       }},
      {{"pyramid_ms", "pyramid", "%.1f"}, [](const Outcome& o) -> Value { return msOf(o.run, {Patches}); }},
      {{"refine_ms", "refine", "%.1f"},
       [](const Outcome& o) -> Value {
         return msOf(o.run, {Stencil, Refine});
       }},
      {{"light_ms", "light", "%.1f"},
       [](const Outcome& o) -> Value {
         return msOf(o.run, {Gather, Splat});
       }},
      {{"upsample_ms", "upsample", "%.1f"}, [](const Outcome& o) -> Value { return msOf(o.run, {Upsample}); }},
      {{"frame_ms", "frame, ms", "%.1f"}, [](const Outcome& o) -> Value { return frameMs(o.run); }},
      {{"fps", "fps", "%.2f"}, [](const Outcome& o) -> Value { return 1000 / frameMs(o.run); }}};
  return columns;
}

const char* xLabel(const PaperFigure& figure) { return figure.overTime ? "seconds" : figure.x.setting.c_str(); }

/// One plot for each technique and curve, with a line for each value of the series.
std::vector<Plot> plotsOf(const PaperFigure& figure, const Value& rows) {
  std::vector<Plot> plots;
  for (const std::string& technique : figure.techniques)
    for (const FigureCurve& curve : figure.curves) {
      Plot plot{technique, xLabel(figure), curve.label, !figure.overTime};
      plot.ticksAtValues = !figure.overTime;
      bool any = false;
      for (const Value& row : rows.items()) {
        if (row["technique"].text() != technique || !row.has("x") || !row.has(curve.key)) continue;
        const std::string name = row.has("series") ? figure.series.setting + " " + row["series"].text() : technique;
        if (plot.lines.empty() || plot.lines.back().name != name) plot.lines.push_back({name, {}, {}});
        plot.lines.back().x.push_back(row["x"].number());
        plot.lines.back().y.push_back(curve.factor * row[curve.key].number());
        any |= row[curve.key].number() != 0;
      }
      // Patches are counted where they gather, and hisr's clusters are not: nothing to see of those.
      if (any) plots.push_back(std::move(plot));
    }
  return plots;
}

std::string tableOf(const PaperFigure& figure, const Value& rows) {
  std::vector<Column> columns{{{"technique", "technique"}},
                              {{"picture", "picture"}},
                              {{"series", figure.series.setting.c_str()}},
                              {{"x", xLabel(figure)}},
                              {{"rmse_share", "RMSE, % mean", "%.2f", 100}},
                              {{"rms_shown", "RMS shown, %", "%.2f", 100}},
                              {{"bias", "bias, %", "%+.2f", 100}}};
  std::erase_if(columns, [&](const Column& c) { // what no row has
    return std::ranges::none_of(rows.items(), [&](const Value& row) { return row.has(c.shown.key); });
  });
  columns.insert(columns.end(), timeColumns().begin(), timeColumns().end());
  return tableText(columns, rows);
}

/// One setting over its values, ascending; the value in use is among them.
struct Sweep {
  const char *technique, *setting, *unit;
  std::vector<double> values;
};
const std::vector<Sweep> kPatchSweeps{
    {"multires-gather", "multires.depth", "share of the view distance", {0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5}},
    {"multires-gather", "multires.normal", "range of a component, 0 to 2", {0, 0.05, 0.1, 0.2, 0.3, 0.5, 1, 2}}},
    kClusterSweeps{
        {"hisr", "rsm.tau", "share of the brightest map's light", {0, 0.001, 0.003, 0.01, 0.02, 0.05, 0.1, 0.3}},
        {"isr", "rsm.depth", "share of the distance", {0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5}}};

} // namespace

std::vector<std::string> reflectiveFigureNames() {
  std::vector<std::string> names;
  for (const PaperFigure& f : paperFigures()) names.push_back(f.name);
  return names;
}

void reflectiveFigure(const AccuracyOptions& options) {
  const PaperFigure& figure = *std::ranges::find(paperFigures(), options.figure, &PaperFigure::name);
  Study study(options, options.launch.scene,
              {.size = "512x512",
               .quickSize = "48x27",
               .set = options.quick
                          ? Assignments{{"gather.glossy", "off"}, {"rsm.coarsest", "8"}, {"rsm.resolution", "32"}}
                          : Assignments{{"gather.glossy", "off"}}, // matt, but for figure 2.6
               .punctual = true});
  LaunchContext& opened = *study.opened;
  if (figure.overTime && !opened.shot)
    throw InputError(study.launch.scene, "not a shot (a .json file, with moving lights)");
  const fs::path folder =
      reportFolder(options.output, format("out/figure-%s", figure.name), {"figure.csv", "figure.svg"});
  opened.settings.effects[EffectId::Redraw] = EffectMode::On;
  std::optional<Baseline> baseline;
  if (figure.truth != FigureTruth::None)
    baseline = baselineOf(study, figure.truth == FigureTruth::Texels, folder / "baseline.png");

  std::vector<LightView> lights;
  RunPlan plan = planOf(opened, options.quick ? 4 : 0);
  if (!figure.overTime) {
    // Lights waver, so that every stage runs in every frame; in the last they are where the baseline has them.
    plan = stillPlan(opened, Buffer::Indirect, options.quick ? 3 : 5);
    plan.view = [&](int frame) { return unsteady(opened.at(0), frame, lights); };
  }
  plan.skip = 1;
  const std::vector<Row> rows = rowsOf(figure, options.quick);
  std::vector<Variant> variants;
  for (const Row& row : rows) variants.push_back(study.variant(row.technique, row.set, row.technique));
  const std::vector<Measured> runs = run(variants, plan, "drawing", options.output.quiet);

  Value report = Value::list(), printed = report; // over time a line each is printed, of medians
  for (size_t i = 0; i < runs.size(); ++i) {
    const Row& row = rows[i];
    Value own = Value::of("technique", row.technique);
    if (!row.picture.empty()) own["picture"] = row.picture;
    if (!row.series.empty()) own["series"] = row.series;
    if (!row.x.empty()) own["x"] = std::stod(row.x);
    for (size_t f = 0; figure.overTime && f < runs[i].frames.size(); ++f) {
      Value& frame = report.add(own);
      frame.update(study.row(timeColumns(), {.variant = runs[i].variant, .frames = {runs[i].frames[f]}}));
      frame["x"] = double(f + size_t(plan.skip)) / opened.shot->fps;
    }
    own.update(study.row(timeColumns(), runs[i]));
    if (baseline) {
      const Image shown = addErrors(own, runs[i].image, *baseline);
      // Splatted or gathered, it is the same picture.
      if (!row.picture.empty()) writeShownBesideTruth(folder, row.picture, shown, baseline->shown);
    }
    printed.add(own);
    if (!figure.overTime) report.add(own);
  }
  for (const FigurePicture& n : figure.pictures) {
    if (n.buffer == Buffer::Indirect) continue;
    Viewer gi(study.variant(n.name, n.set, n.technique).settings, opened.seed);
    gi.run(opened.at(0));
    writeBuffer(folder / (std::string(n.name) + ".png"), gi, n.buffer);
  }
  writeText(folder / "figure.csv", csvText(report));
  const std::vector<Plot> plots = plotsOf(figure, report);
  if (!plots.empty()) writeText(folder / "figure.svg", svgOf(plots, 3));
  writeJson(options.output.json, Value::of("figure", figure.name, "rows", report));
  if (!options.output.quiet)
    std::printf("%s, %d x %d\n\n%s\nreport (differences times 8): %s\n", figure.title, opened.camera.width,
                opened.camera.height, tableOf(figure, printed).c_str(), folder.c_str());
}

void accuracyCurve(const AccuracyOptions& options) {
  const std::string& kind = options.curve;
  const bool patches = kind == "patches";
  // Many VPLs, as the paper, to tell the error of patches from that of VPLs; --set comes after.
  Study study(options, options.launch.scene,
              {.quickSize = "", .set = patches ? Assignments{{"rsm.vpls", "16384"}} : Assignments{}, .punctual = true});
  LaunchContext& opened = *study.opened;
  const fs::path folder = reportFolder(options.output, "out/accuracy", {kind + ".csv", kind + ".svg"});
  opened.settings.effects[EffectId::Redraw] = EffectMode::On;
  const Baseline baseline = baselineOf(study, !patches, folder / (kind + "-baseline.png"));
  Value all = Value::list();
  std::vector<Plot> plots;
  std::string tables, pictured;
  for (Sweep sweep : patches ? kPatchSweeps : kClusterSweeps) {
    const Assignments atPixels{{"gather.mode", "full"}}; // of clusters
    const Variant own = study.variant(sweep.technique, patches ? Assignments{} : atPixels, sweep.technique);
    const double inUse = std::stod(settingText(own.settings, sweep.setting));
    const bool standard = settingText(own.settings, sweep.setting) == settingText(Settings{}, sweep.setting);
    if (std::ranges::count(sweep.values, inUse) == 0)
      sweep.values.insert(std::ranges::lower_bound(sweep.values, inUse), inUse);
    std::vector<Variant> variants;
    for (double value : sweep.values)
      applySetting(variants.emplace_back(own).settings, sweep.setting, format("%.9g", value));
    const auto runs = run(variants, stillPlan(opened, Buffer::Indirect, 2, 1), // shaders are compiled in the first
                          "curve of " + kind, options.output.quiet);
    Plot& plot = plots.emplace_back(sweep.technique, std::string(sweep.setting) + ", " + sweep.unit, "error, %");
    plot.ticksAtValues = true, plot.inUse = inUse;
    PlotLine rmse{"RMSE, share of mean indirect radiance", sweep.values, {}},
        shownRms{"RMS on the display", sweep.values, {}};
    Value points;
    for (size_t i = 0; i < runs.size(); ++i) {
      const bool used = sweep.values[i] == inUse;
      Value& point = points.add(
          Value::of("technique", sweep.technique, "setting", sweep.setting, "value", sweep.values[i], "in_use", used));
      point["gather_ms"] = runs[i].ms(StageId::Gather).median;
      point["vpls"] = runs[i].frames.back().vplsAlive; // 0: each fragment has clusters of its own
      const Image shown = addErrors(point, runs[i].image, baseline);
      rmse.y.push_back(100 * point["rmse_share"].number());
      shownRms.y.push_back(100 * point["rms_shown"].number());
      all.add(point);
      point["use"] = !used ? "" : standard ? "<- default" : "<- as set";
      if (used && std::exchange(pictured, sweep.technique) != sweep.technique)
        writeShownBesideTruth(folder, kind + "-" + sweep.technique, shown, baseline.shown);
    }
    plot.lines = {rmse, shownRms};
    tables += tableText(std::vector<TableColumn>{{"technique", "technique"},
                                                 {"value", sweep.setting},
                                                 {"rmse_share", "RMSE, % mean", "%.3f", 100},
                                                 {"rms_shown", "RMS shown, %", "%.3f", 100},
                                                 {"bias", "bias, %", "%+.2f", 100},
                                                 {"gather_ms", "gather, ms", "%.1f"},
                                                 {"vpls", "VPLs", "%g", 1, "a cut"},
                                                 {"use", ""}},
                        points) +
              "\n";
  }
  writeText(folder / (kind + ".csv"), csvText(all));
  writeText(folder / (kind + ".svg"), svgOf(plots, 4));
  writeJson(options.output.json, Value::of("points", all));
  if (!options.output.quiet)
    std::printf("%s, %d x %d\n\n%splot, table and pictures (differences times 8): %s\n",
                patches ? "light gathered at patches of the picture, against the same VPLs gathered at every pixel"
                        : "clusters of the reflective maps, against every texel of them; both gathered at every pixel",
                opened.camera.width, opened.camera.height, tables.c_str(), (folder / kind).c_str());
}

} // namespace lambent
