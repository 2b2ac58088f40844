// lambent bench SCENE --growth: how the time of each stage grows with one thing at a time, the values in turn, frame by
// frame. Camera and lights waver, so that every stage works in every frame.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/scaled_view.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/html.h"
#include "tools/lambent/plot.h"
#include "tools/lambent/text.h"

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
  OnScaledView(const Variant& v, std::shared_ptr<ScaledView> scaled)
      : inner_(wholeFrames(v)), scaled_(std::move(scaled)) {}
  const FrameStats& run(const SceneView& view) override { return inner_->run(scaled_->of(view)); }
  std::vector<TrackedValue> at(std::span<const vec2> points) const override { return inner_->at(points); }

 private:
  std::unique_ptr<Runner> inner_;
  std::shared_ptr<ScaledView> scaled_;
};

/// One thing at four values or more, and all else the same.
struct Sweep {
  const char *name, *title;
  std::vector<double> values;
  std::vector<Variant> variants; // beside `values`
};

/// Of what `count` counts in the views that `make` gives.
Sweep sweepOf(const char* name, const char* title, const std::vector<float>& factors, const LaunchContext& stage,
              const SceneView& view, const std::function<std::shared_ptr<ScaledView>(float)>& make,
              const std::function<double(const SceneView&)>& count) {
  Sweep sweep{name, title, {}, {}};
  for (float factor : factors) {
    const std::shared_ptr<ScaledView> scaled = make(factor);
    sweep.values.push_back(count(scaled->of(view)));
    sweep.variants.push_back({format("%s x %g", name, factor), stage.settings, stage.seed,
                              [scaled](const Variant& v) { return std::make_unique<OnScaledView>(v, scaled); }});
  }
  return sweep;
}

Sweep sweepOf(const std::string& name, const LaunchContext& stage, const SceneView& view) {
  if (name == "vpls") {
    Sweep sweep{"vpls", "virtual lights, N", {}, {}};
    for (int quarters : {1, 2, 4, 8}) {
      Variant& v = sweep.variants.emplace_back("vpls", stage.settings, stage.seed);
      v.settings.smc.vpls = std::max(quarters, stage.settings.smc.vpls / 4 * quarters);
      sweep.values.push_back(v.settings.smc.vpls);
    }
    return sweep;
  }
  if (name == "pixels")
    return sweepOf(
        "pixels", "pixels", {0.5f, std::sqrt(0.5f), 1, std::sqrt(2.0f), 2}, stage, view,
        [](float side) { return std::make_shared<ResizedPicture>(side); },
        [](const SceneView& v) { return double(v.camera.width) * v.camera.height; });
  if (name == "lights")
    return sweepOf(
        "lights", "punctual lights, of the same intensity in all", {1, 2, 4, 8}, stage, view,
        [](float count) { return std::make_shared<SplitLights>(uint32_t(count)); },
        [](const SceneView& v) { return double(v.lights.size()); });
  if (name == "instances")
    return sweepOf(
        "instances", "instances, of the same triangles in all", {1, 2, 4, 8}, stage, view,
        [&](float parts) { return std::make_shared<SplitInstances>(*view.assets, uint32_t(parts)); },
        [](const SceneView& v) { return double(v.instances.size()); });
  return sweepOf(
      "triangles", "triangles, of the same surface in all", {1, 2, 3, 4}, stage, view,
      [&](float n) { return std::make_shared<SplitTriangles>(*view.assets, uint32_t(n)); },
      [](const SceneView& v) { return double(trianglesOf(v)); });
}

/// The camera a two-hundredth of the scene aside and back, in eight steps.
SceneView swayed(SceneView view, int frame) {
  constexpr float kShare = 0.005f;
  const float aside = std::sin(2 * kPi * float(frame % 8) / 8);
  view.camera.worldFromView[3] += kShare * view.boundsWorld.diameter() * aside * view.camera.worldFromView[0];
  view.changes.camera = true;
  return view;
}

/// Times over the values, and what was fitted: a row for each stage.
nlohmann::json rowsOf(const Sweep& sweep, const std::vector<Measured>& runs) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Line& line : timeLines(runs)) {
    std::vector<double> medians;
    nlohmann::json quartiles;
    for (const Measured& m : runs) {
      const Spread s = line.of(m);
      medians.push_back(s.median);
      quartiles.push_back({s.quarter, s.threeQuarters});
    }
    nlohmann::json& row =
        rows.emplace_back(nlohmann::json{{"stage", line.name}, {"median_ms", medians}, {"quartiles_ms", quartiles}});
    if (std::ranges::min(medians) < kShortestMs) {
      row["left_out"] = "too short";
      continue;
    }
    row["exponent"] = exponentOf(sweep.values, medians);
    row["exponent_error"] = exponentError(sweep.values, medians);
  }
  return rows;
}

/// Of the stages that take longest at the last value, and of the frame.
Plot plotOf(const Sweep& sweep, const nlohmann::json& rows) {
  Plot plot{.title = std::string("cost over ") + sweep.name,
            .xLabel = sweep.title,
            .yLabel = "median time, ms",
            .x = sweep.values,
            .series = {}};
  plot.logarithmic = true;
  std::vector<nlohmann::json> fitted;
  for (const nlohmann::json& row : rows)
    if (row.contains("exponent") && row["stage"] != "updateVpls") fitted.push_back(row);
  std::ranges::stable_sort(fitted, std::greater(), [](const nlohmann::json& row) {
    return row["stage"] == "frame" ? 1e30 : row["median_ms"].back().get<double>();
  });
  for (const nlohmann::json& row : fitted) {
    if (plot.series.size() > kMostLines) break;
    plot.series.push_back(
        {row["stage"].get<std::string>() + format(", exponent %.2f", row["exponent"].get<double>()), row["median_ms"]});
  }
  return plot;
}

std::string tableOf(const Sweep& sweep, const nlohmann::json& rows) {
  std::vector<std::string> keys, titles;
  for (double value : sweep.values) {
    keys.push_back(format("at %zu", keys.size()));
    titles.push_back(format("%s %.0f", sweep.name, value));
  }
  std::vector<TableColumn> columns{{"stage", "ms, median (quartiles)"}};
  for (size_t i = 0; i < keys.size(); ++i) columns.push_back({keys[i].c_str(), titles[i].c_str()});
  columns.push_back({"grows", "exponent"});
  nlohmann::json lines = nlohmann::json::array();
  for (const nlohmann::json& row : rows) {
    nlohmann::json& line = lines.emplace_back(nlohmann::json{{"stage", row["stage"]}});
    for (size_t i = 0; i < keys.size(); ++i)
      line[keys[i]] = spreadText({.median = row["median_ms"][i],
                                  .quarter = row["quartiles_ms"][i][0],
                                  .threeQuarters = row["quartiles_ms"][i][1]});
    line["grows"] = row.contains("exponent")
                        ? format("%+.2f ± %.2f", row["exponent"].get<double>(), row["exponent_error"].get<double>())
                        : row["left_out"].get<std::string>();
  }
  return tableText(columns, lines);
}

std::string csvOf(const nlohmann::json& sweeps) {
  nlohmann::json flat = nlohmann::json::array();
  for (const nlohmann::json& sweep : sweeps)
    for (const nlohmann::json& row : sweep["rows"])
      for (size_t i = 0; i < sweep["values"].size(); ++i)
        flat.push_back({{"over", sweep["over"]},
                        {"value", sweep["values"][i]},
                        {"stage", row["stage"]},
                        {"median_ms", row["median_ms"][i]},
                        {"quarter_ms", row["quartiles_ms"][i][0]},
                        {"three_quarters_ms", row["quartiles_ms"][i][1]}});
  return csvText(flat);
}

} // namespace

void benchGrowth(const BenchOptions& options) {
  const auto stage = openLaunch(options.launch);
  if (!needsOf(stage->settings).sampled())
    throw InputError("--technique " + options.launch.technique, "has no sampled lights (smc, ir, mir and tcas have)");
  say(*stage, options.output.quiet);
  const fs::path folder = reportFolder(options.output.out, "out/bench");
  if (!stage->shot) stage->settings.effects[EffectId::Redraw] = EffectMode::On;
  const SceneView first = stage->at(0);
  std::vector<std::string> names = options.along;
  if (names.empty()) {
    names = {"vpls", "pixels", "lights", "instances", "triangles"};
    if (first.lights.empty()) std::erase(names, "lights");
  } else if (first.lights.empty() && std::ranges::count(names, "lights")) {
    throw InputError("--along lights", "the scene has no punctual light (--point or --sun adds one)");
  }
  const GlContext context = GlContext::headless();
  nlohmann::json sweeps = nlohmann::json::array();
  std::vector<Plot> plots;
  std::string tables;
  for (const std::string& name : names) {
    const Sweep sweep = sweepOf(name, *stage, stage->at(0));
    Progress progress("over " + name, options.output.quiet);
    RunPlan plan = benchPlan(options, *stage, progress, kFrames);
    std::vector<LightView> lights;
    plan.view = [&, posed = plan.view](int frame) {
      SceneView view = unsteady(posed(frame), frame, lights);
      view = stage->shot ? view : swayed(view, frame);
      if (frame == 0) view.changes = {}; // the last sweep's extraction may have been of the same
      return view;
    };
    const std::vector<Measured> runs = measure(sweep.variants, plan);
    const nlohmann::json rows = rowsOf(sweep, runs);
    sweeps.push_back({{"over", name}, {"values", sweep.values}, {"frames", runs[0].frames.size()}, {"rows", rows}});
    plots.push_back(plotOf(sweep, rows));
    tables += tableOf(sweep, rows) + "\n";
  }
  const std::string machine = machineText(context);
  writeJson(options.output.json, {{"scene", options.launch.scene},
                                  {"size", {stage->camera.width, stage->camera.height}},
                                  {"machine", machine},
                                  {"shortest_ms", kShortestMs},
                                  {"sweeps", sweeps}});
  const std::string conditions =
      options.launch.scene + ", " + std::to_string(stage->camera.width) + " x " + std::to_string(stage->camera.height) +
      ", " + machine + "; " +
      (stage->shot ? "the camera follows the shot, punctual lights waver" : "camera and punctual lights waver") +
      ". Time grows as value^exponent: slope of least squares of the " +
      "logarithms of medians, ± its standard error; stages below " + format("%g", kShortestMs) +
      " ms at some value are too short to fit.\n";
  writeText(folder / "growth.svg", svgOf(plots, 2));
  writeText(folder / "growth.csv", csvOf(sweeps));
  writeText(folder / "growth.md",
            escaped("# How cost grows\n\n" + conditions + "\n" + tables + "![Median times over each](growth.svg)\n"));
  if (!options.output.quiet)
    std::printf("%s\n%sreport: %s\n", conditions.c_str(), tables.c_str(), (folder / "growth.md").c_str());
}

} // namespace lambent
