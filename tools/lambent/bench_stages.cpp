// lambent bench --table2 SHOT..., --multires SCENE...: times of a frame by the steps of a paper, each of which sums
// stages of ours. Paper 1's table 2, where the time of a sequence goes; paper 3's table 1, light gathered at patches of
// the picture against light splatted into them, from the same reflective shadow maps, frame by frame in turn.
#include "engine/core/error.h"
#include "gi/measure/scaled_view.h"
#include "tools/lambent/bench.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

using enum StageId;

/// A step of a paper, and the stages of ours that it sums.
struct Step {
  const char *key, *title;
  std::vector<StageId> stages;
};
using Steps = std::vector<Step>;

double msOf(const FrameStats& s, const Steps& steps) {
  double ms = 0;
  for (const Step& step : steps) ms += msOf(s, step.stages);
  return ms;
}

/// Paper 1's "generating candidate VPLs, detecting undersampled regions and replacing invalidated VPLs" is three stages
/// here; its G-buffer is part of the shading. Stages of other techniques count where their like does. What we do beyond
/// the paper has a column of its own.
const Steps kSampling{{"candidates", "candidates", {Points, Candidates, Replace, Photons, Chains}},
                      {"resampling", "resampling", {Resample}},
                      {"visibility", "indirect visibility", {Validate}},
                      {"radiosity", "radiosity", {Radiosity}},
                      {"density", "density", {Density}}};
const Steps kRendering{{"maps", "shadow maps", {VplMaps, MapComparison}},
                       {"shading",
                        "shading",
                        {Surfaces, Vpls, Lists, Gather, GatherByRays, IrradianceUpload, Patches, Stencil, Refine, Splat,
                         SplatPerVpl, Upsample, Filter}},
                       {"beyond", "beyond the paper", {MapChecks, NearLight, History}}};

/// All columns with times, in order, totals where the paper has them. The rest of the frame is direct light, the
/// scene's own upkeep and what puts the picture together.
struct Timed {
  const char *key, *title;
  std::function<double(const FrameStats&)> ms;
};
const std::vector<Timed>& timedColumns() {
  static const std::vector<Timed> all = [] {
    std::vector<Timed> out;
    const auto add = [&](const Steps& steps, const char* key, const char* title) {
      for (const Step& step : steps)
        out.push_back({step.key, step.title, [&step](const FrameStats& s) { return msOf(s, step.stages); }});
      out.push_back({key, title, [&steps](const FrameStats& s) { return msOf(s, steps); }});
    };
    add(kSampling, "sampling_total", "sampling, total");
    add(kRendering, "rendering_total", "rendering, total");
    const auto indirect = [](const FrameStats& s) { return msOf(s, kSampling) + msOf(s, kRendering); };
    out.push_back({"indirect_total", "indirect, total", indirect});
    out.push_back({"rest", "rest", [indirect](const FrameStats& s) { return s.wallMs - indirect(s); }});
    out.push_back({"frame", "frame", [](const FrameStats& s) { return s.wallMs; }});
    return out;
  }();
  return all;
}

/// Paper 1, table 2: thousands of triangles, VPLs, milliseconds at 1920 × 1080 on a GTX Titan X and an i7 4820K, of the
/// first timed columns. There the indirect total is all, since the rest is not given.
struct Published {
  const char *shot, *name; // of ours that follows it; theirs
  double triangles, vpls, ms[11];
};
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

Value rowOf(const BenchOptions& options, const std::string& file, std::string& machine) {
  Study study(options, file, {});
  LaunchContext& opened = *study.opened;
  machine = machineText(study.context);
  if (!opened.shot) throw InputError(file, "not a shot (a .json file)");
  needSampledLights(techniqueOf(opened.settings).name);
  if (opened.settings.frame.overlap)
    throw InputError("setting frame.overlap", "cannot be on here (what runs beside a frame is no part of its time)");
  RunPlan plan = benchPlan(options, opened);
  size_t triangles = 0;
  plan.view = [&, posed = plan.view](int frame) {
    const SceneView view = posed(frame);
    triangles = trianglesOf(view);
    return view;
  };
  const std::string name = nameOf(file);
  const Measured m = run({study.variant(name)}, plan, name, options.output.quiet)[0];
  Value row = Value::of("shot", name, "triangles", triangles, "vpls", opened.settings.smc.vpls, "size",
                        std::vector{opened.camera.width, opened.camera.height}, "frames", m.frames.size());
  for (const Timed& column : timedColumns()) addSpread(row, column.key, m.of(column.ms));
  const Published* paper = publishedOf(name);
  if (!paper) return row;
  row["paper_1"] = Value::of("triangles", paper->triangles, "vpls", paper->vpls);
  for (size_t i = 0; i < std::size(paper->ms); ++i) row["paper_1"]["median_ms"][timedColumns()[i].key] = paper->ms[i];
  return row;
}

/// What is shown of a row, ours or the paper's.
Value cellsOf(const std::string& name, const Value& row) {
  Value cells = Value::of("shot", name, "triangles", row["triangles"], "vpls", row["vpls"]);
  for (const auto& [key, median] : row["median_ms"].fields())
    cells[key] = row.has("quartiles_ms") ? spreadText(median.number(), row["quartiles_ms"][key])
                                         : format("%.1f", median.number());
  return cells;
}

std::string table2Text(const Value& rows) {
  std::vector<TableColumn> titles{{"shot", "ms"}, {"triangles", "triangles", "%.0f"}, {"vpls", "N"}};
  for (const Timed& column : timedColumns()) titles.push_back({column.key, column.title});
  Value lines = Value::list();
  for (const Value& row : rows.items()) {
    const std::string& shot = row["shot"].text();
    lines.add(cellsOf(shot, row));
    if (row.has("paper_1")) lines.add(cellsOf(std::string("paper 1: ") + publishedOf(shot)->name, row["paper_1"]));
  }
  return tableText(titles, lines);
}

std::string table2Csv(const Value& rows) {
  Value flat = Value::list();
  for (const Value& row : rows.items()) {
    Value& line = flat.add(Value::of("shot", row["shot"], "triangles", row["triangles"], "vpls", row["vpls"]));
    for (const auto& [key, median] : row["median_ms"].fields()) {
      line[key + "_ms"] = median;
      line[key + "_ms_quarter"] = row["quartiles_ms"][key].items()[0];
      line[key + "_ms_three_quarters"] = row["quartiles_ms"][key].items()[1];
    }
    if (row.has("paper_1"))
      for (const auto& [key, ms] : row["paper_1"]["median_ms"].fields()) line[key + "_ms_paper_1"] = ms;
  }
  return csvText(flat);
}

/// Which stages each column sums.
std::string mappingText() {
  std::string text;
  for (const Steps* half : {&kSampling, &kRendering})
    for (const Step& step : *half) {
      text += std::string(text.empty() ? "" : "; ") + step.title + " = ";
      for (StageId stage : step.stages)
        text += std::string(stage == step.stages[0] ? "" : " + ") + kStageNames[size_t(stage)];
    }
  return "Stages: " + text + "; rest = all else of the frame.";
}

/// Paper 3's table 1: what the paper calls the steps, in either half. The first has what no other names: as the
/// paper's, it "includes all other rendering overhead".
const Steps kMultires{{"direct", "Direct light", {}},
                      {"reflective_maps", "Generate reflective shadow map", {ReflectiveMaps, ReflectiveLights}},
                      {"mipmap", "Create min-max mipmap", {Patches}},
                      {"refinement", "Multires stencil setup", {Stencil, Refine}},
                      {"light", "Multires light gather", {Gather, Splat}},
                      {"upsample", "Upsample indirect illumination", {Upsample}}};
const char* titleOf(const Step& step, bool splatting) {
  if (splatting && step.key == std::string("refinement")) return "Geometry shader refinement";
  return splatting && step.key == std::string("light") ? "Multires light splatting" : step.title;
}
constexpr const char* kTechniques[] = {"multires-gather", "multires-splat"};

/// All figures of one scene: a column of the table.
Value columnOf(const BenchOptions& options, const std::string& file) {
  Study study(options, file, {.punctual = true});
  RunPlan plan = benchPlan(options, *study.opened);
  std::vector<LightView> lights;
  plan.view = [&, steady = plan.view](int frame) { return unsteady(steady(frame), frame, lights); };
  plan.buffer = Buffer::Indirect;
  const std::vector<Measured> halves =
      run({study.variant(kTechniques[0], {}, kTechniques[0]), study.variant(kTechniques[1], {}, kTechniques[1])}, plan,
          nameOf(file), options.output.quiet);
  const CameraView& camera = study.opened->camera;
  const FrameStats& gathered = halves[0].frames.back();
  Value column = Value::of("scene", file, "size", std::vector{camera.width, camera.height}, "frames",
                           halves[0].frames.size(), "vpls", gathered.vplsAlive, "patches", gathered.patches,
                           "rmse_share", imageError(halves[1].image, halves[0].image).rmseShare());
  for (const Measured& half : halves) {
    Value& ms = column["median_ms"][half.variant.name];
    for (const Step& step : kMultires)
      ms[step.key] = half.of([&](const FrameStats& s) {
                           return step.stages.empty() ? s.wallMs - msOf(s, kMultires) : msOf(s, step.stages);
                         })
                         .median;
    ms["total"] = frameMs(half);
  }
  const Value& ms = column["median_ms"];
  for (const char* step : {"light", "total"}) {
    const double gather = ms[kTechniques[0]][step].number(), splat = ms[kTechniques[1]][step].number();
    column["splat_over_gather"][step] = gather > 0 ? splat / gather : 0;
  }
  return column;
}

void printLine(const Value& columns, const std::string& title, const std::function<std::string(const Value&)>& cell) {
  std::printf("  %-32s", title.c_str());
  for (const Value& c : columns.items())
    std::printf(" %*s", int(std::max<size_t>(10, nameOf(c["scene"].text()).size())), cell(c).c_str());
  std::printf("\n");
}

std::string sizeText(const Value& row) {
  const std::vector<double> size = row["size"].numbers();
  return format("%.0f x %.0f", size[0], size[1]);
}

} // namespace

void benchTable2(const BenchOptions& options) {
  const fs::path folder = reportFolder(options.output, "out/bench", {"table2.csv", "table2.md"});
  Value rows;
  std::string machine;
  for (const std::string& file : options.scenes) rows.add(rowOf(options, file, machine));
  const Value& first = rows.items()[0];
  writeReport(options.output, folder, "table2", "Where the time of sequences goes",
              sizeText(first) + format(", %.0f frames of the first shot, ", first["frames"].number()) + machine +
                  "; medians (quartiles) in ms; medians of totals are not totals of medians. Paper 1: 1920 x 1080, GTX "
                  "Titan X.\n" +
                  mappingText() + "\n\n" + table2Text(rows),
              table2Csv(rows), Value::of("machine", machine, "rows", rows));
}

void benchMultires(const BenchOptions& options) {
  refuseTechnique(options, "cannot be chosen with --multires, which measures multires-gather and multires-splat");
  Value columns;
  for (const std::string& file : options.scenes) columns.add(columnOf(options, file));
  writeJson(options.output.json, Value::of("scenes", columns));
  if (options.output.quiet) return;
  std::printf("%s, medians in ms; lights waver by a ten-thousandth of the scene, so every stage runs in every frame\n",
              sizeText(columns.items()[0]).c_str());
  for (bool splatting : {false, true}) {
    const char* technique = kTechniques[splatting];
    const auto line = [&](const char* title, const char* key) {
      printLine(columns, title,
                [&](const Value& c) { return format("%.2f", c["median_ms"][technique][key].number()); });
    };
    printLine(columns, technique, [](const Value& c) { return nameOf(c["scene"].text()); });
    for (const Step& step : kMultires) line(titleOf(step, splatting), step.key);
    line("Total", "total");
    std::printf("\n");
  }
  for (const char* step : {"light", "total"})
    printLine(columns, std::string("splat over gather, ") + step,
              [&](const Value& c) { return format("%.2f", c["splat_over_gather"][step].number()); });
  for (const auto& [key, title, pattern, factor] : {std::tuple{"vpls", "VPLs", "%.0f", 1.0},
                                                    {"patches", "Patches", "%.0f", 1.0},
                                                    {"rmse_share", "RMSE of the two, % of mean", "%.3f", 100.0},
                                                    {"frames", "frames", "%.0f", 1.0}})
    printLine(columns, title, [&](const Value& c) { return format(pattern, factor * c[key].number()); });
}

} // namespace lambent
