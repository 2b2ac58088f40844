// lambent bench SCENE --growth: how the time of each stage grows with one thing at a time, the values in turn, frame by
// frame. Camera and lights waver, so that every stage works in every frame.
#include "engine/core/error.h"
#include "gi/measure/scaled_view.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Stages that take less than this at any value are not fitted: what is timed then is the timing.
constexpr double kShortestMs = 0.02;
constexpr int kFrames = 32;      // of a scene
constexpr size_t kMostLines = 5; // of a plot, besides the frame

/// Draws the frames of another view than it is given.
class OnScaledView final : public Runner {
 public:
  OnScaledView(const Variant& v, ScaledView scaled) : inner_(wholeFrames(v)), scaled_(std::move(scaled)) {}
  const FrameStats& run(const SceneView& view) override { return inner_->run(scaled_(view)); }
  std::vector<TrackedValue> at(std::span<const vec2> points) const override { return inner_->at(points); }

 private:
  std::unique_ptr<Runner> inner_;
  ScaledView scaled_;
};

/// One thing, of which a view has more by a factor, and all else the same.
struct Growing {
  const char *name, *title;
  std::vector<float> factors;
  ScaledView (*scaled)(float, const SceneAssets&) = nullptr; // null: by the settings
  double (*count)(const SceneView&) = nullptr;
};
constexpr float kRoot = 1.41421356f;
const Growing kGrowing[] = {{"vpls", "virtual lights, N", {0.25f, 0.5f, 1, 2}},
                            {"pixels",
                             "pixels",
                             {0.5f, kRoot / 2, 1, kRoot, 2},
                             [](float f, const SceneAssets&) { return resizedImage(f); },
                             [](const SceneView& v) { return double(v.camera.width) * v.camera.height; }},
                            {"lights",
                             "punctual lights, of the same intensity in all",
                             {1, 2, 4, 8},
                             [](float f, const SceneAssets&) { return splitLights(uint32_t(f)); },
                             [](const SceneView& v) { return double(v.lights.size()); }},
                            {"instances",
                             "instances, of the same triangles in all",
                             {1, 2, 4, 8},
                             [](float f, const SceneAssets& a) { return splitInstances(a, uint32_t(f)); },
                             [](const SceneView& v) { return double(v.instances.size()); }},
                            {"triangles",
                             "triangles, of the same surface in all",
                             {1, 2, 3, 4},
                             [](float f, const SceneAssets& a) { return splitTriangles(a, uint32_t(f)); },
                             [](const SceneView& v) { return double(trianglesOf(v)); }}};

/// The camera a two-hundredth of the scene aside and back, in eight steps.
SceneView swayed(SceneView view, int frame) {
  constexpr float kShare = 0.005f;
  const float aside = std::sin(2 * kPi * float(frame % 8) / 8);
  view.camera.worldFromView[3] += kShare * view.boundsWorld.diameter() * aside * view.camera.worldFromView[0];
  view.changes.camera = true;
  return view;
}

/// Variants next to how much of the thing they have.
std::vector<Variant> variantsOf(const Growing& growing, LaunchContext& opened, std::vector<double>& values) {
  const SceneView view = opened.at(0);
  std::vector<Variant> variants;
  for (float factor : growing.factors) {
    Variant& v = variants.emplace_back(variantOf(opened, format("%s x %g", growing.name, factor)));
    if (!growing.scaled) {
      const int quarters = int(4 * factor);
      v.settings.smc.vpls = std::max(quarters, opened.settings.smc.vpls / 4 * quarters);
      values.push_back(v.settings.smc.vpls);
      continue;
    }
    const ScaledView scaled = growing.scaled(factor, *view.assets);
    values.push_back(growing.count(scaled(view)));
    v.make = [scaled](const Variant& own) { return std::make_unique<OnScaledView>(own, scaled); };
  }
  return variants;
}

/// Times over the values, and what was fitted: a row for each stage.
Value rowsOf(const std::vector<double>& values, const std::vector<Measured>& runs) {
  Value rows = Value::list();
  for (const Line& line : timeLines(runs)) {
    std::vector<double> medians;
    Value& row = rows.add(Value::of("stage", line.name));
    for (const Measured& m : runs) {
      const Spread s = line.of(m);
      medians.push_back(s.median);
      row["quartiles_ms"].add(std::vector{s.quarter, s.threeQuarters});
    }
    row["median_ms"] = medians;
    if (std::ranges::min(medians) < kShortestMs) {
      row["left_out"] = "too short";
      continue;
    }
    row["exponent"] = exponentOf(values, medians);
    row["exponent_error"] = exponentError(values, medians);
  }
  return rows;
}

/// Of the stages that take longest at the last value, and of the frame.
Plot plotOf(const Growing& growing, const std::vector<double>& values, const Value& rows) {
  Plot plot{std::string("cost over ") + growing.name, growing.title, "median time, ms"};
  plot.logY = plot.ticksAtValues = true;
  Value::List fitted;
  for (const Value& row : rows.items())
    if (row.has("exponent") && row["stage"].text() != "updateVpls") fitted.push_back(row);
  std::ranges::stable_sort(fitted, std::greater(), [](const Value& row) {
    return row["stage"].text() == "frame" ? 1e30 : row["median_ms"].items().back().number();
  });
  for (size_t i = 0; i < std::min(fitted.size(), kMostLines + 1); ++i)
    plot.lines.push_back({fitted[i]["stage"].text() + format(", exponent %.2f", fitted[i]["exponent"].number()), values,
                          fitted[i]["median_ms"].numbers()});
  return plot;
}

std::string tableOf(const Growing& growing, const std::vector<double>& values, const Value& rows) {
  std::vector<std::string> keys, titles;
  for (double value : values) {
    keys.push_back(format("at %zu", keys.size()));
    titles.push_back(format("%s %.0f", growing.name, value));
  }
  std::vector<TableColumn> columns{{"stage", "ms, median (quartiles)"}};
  for (size_t i = 0; i < keys.size(); ++i) columns.push_back({keys[i].c_str(), titles[i].c_str()});
  columns.push_back({"grows", "exponent"});
  Value lines = Value::list();
  for (const Value& row : rows.items()) {
    Value& line = lines.add(Value::of("stage", row["stage"]));
    for (size_t i = 0; i < keys.size(); ++i)
      line[keys[i]] = spreadText(row["median_ms"].items()[i].number(), row["quartiles_ms"].items()[i]);
    line["grows"] = row.has("exponent")
                        ? format("%+.2f ± %.2f", row["exponent"].number(), row["exponent_error"].number())
                        : row["left_out"].text();
  }
  return tableText(columns, lines);
}

std::string growthCsv(const Value& sweeps) {
  Value flat = Value::list();
  for (const Value& sweep : sweeps.items())
    for (const Value& row : sweep["rows"].items())
      for (size_t i = 0; i < sweep["values"].size(); ++i)
        flat.add(Value::of("over", sweep["over"], "value", sweep["values"].items()[i], "stage", row["stage"],
                           "median_ms", row["median_ms"].items()[i], "quarter_ms",
                           row["quartiles_ms"].items()[i].items()[0], "three_quarters_ms",
                           row["quartiles_ms"].items()[i].items()[1]));
  return csvText(flat);
}

} // namespace

void benchGrowth(const BenchOptions& options) {
  Study study(options, options.launch.scene, {});
  LaunchContext& opened = *study.opened;
  needSampledLights(techniqueOf(opened.settings).name);
  const fs::path folder = reportFolder(options.output, "out/bench", {"growth.csv", "growth.md", "growth.svg"});
  if (!opened.shot) opened.settings.effects[EffectId::Redraw] = EffectMode::On;
  const bool lit = !opened.at(0).lights.empty();
  if (!lit && std::ranges::count(options.along, "lights"))
    throw InputError("--along lights", "the scene has no punctual light (--point or --sun adds one)");
  Value sweeps = Value::list();
  std::vector<Plot> plots;
  std::string tables;
  const auto measureAlong = [&](const Growing& growing) {
    std::vector<double> values;
    const std::vector<Variant> variants = variantsOf(growing, opened, values);
    RunPlan plan = benchPlan(options, opened, kFrames);
    std::vector<LightView> lights;
    plan.view = [&, posed = plan.view](int frame) {
      SceneView view = unsteady(posed(frame), frame, lights);
      view = opened.shot ? view : swayed(view, frame);
      if (frame == 0) view.changes = {}; // the last sweep's extraction may have been of the same
      return view;
    };
    const auto runs = run(variants, plan, std::string("over ") + growing.name, options.output.quiet);
    const Value rows = rowsOf(values, runs);
    sweeps.add(Value::of("over", growing.name, "values", values, "frames", runs[0].frames.size(), "rows", rows));
    plots.push_back(plotOf(growing, values, rows));
    tables += tableOf(growing, values, rows) + "\n";
  };
  for (const Growing& growing : kGrowing)
    if (options.along.empty() && (lit || growing.name != std::string("lights"))) measureAlong(growing);
  for (const std::string& name : options.along)
    measureAlong(*std::ranges::find(kGrowing, name, [](const Growing& g) { return std::string(g.name); }));
  const CameraView& camera = opened.camera;
  const std::string machine = machineText(study.context);
  const std::string conditions =
      options.launch.scene + format(", %d x %d, ", camera.width, camera.height) + machine + "; " +
      (opened.shot ? "the camera follows the shot, punctual lights waver" : "camera and punctual lights waver") +
      format(". Time grows as value^exponent: slope of least squares of the logarithms of medians, ± its standard "
             "error; stages below %g ms at some value are too short to fit.\n\n",
             kShortestMs);
  writeText(folder / "growth.svg", svgOf(plots, 2));
  writeReport(options.output, folder, "growth", "How cost grows",
              conditions + tables + "![Median times over each](growth.svg)\n", growthCsv(sweeps),
              Value::of("scene", options.launch.scene, "size", std::vector{camera.width, camera.height}, "machine",
                        machine, "shortest_ms", kShortestMs, "sweeps", sweeps));
}

} // namespace lambent
