// lambent accuracy SCENE --curve patches|clusters: error against threshold as paper 3's figs. 9 and 13, one kind of
// cluster at a time. Patches of the picture are held to the same VPLs gathered at every pixel; clusters of the lights
// to every texel of the reflective maps, both gathered at every pixel.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "tools/lambent/accuracy.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/plot.h"
#include "tools/lambent/reflective_truth.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// One setting over its values, ascending; the value in use is among them.
struct Sweep {
  std::string technique, setting;
  std::vector<double> values;
  const char* unit;
};

/// What a curve is of. `prepare` is applied to the settings of the sweep, after its technique; `truth` to those of the
/// picture that errors are measured against.
struct CurveKind {
  std::string name, title;
  std::vector<Sweep> sweeps;
  std::function<void(Settings&)> prepare, truth;
};

CurveKind curveKind(const std::string& name) {
  if (name == "patches")
    return {
        name,
        "light gathered at patches of the picture, against the same VPLs gathered at every pixel",
        {{"multires-gather",
          "multires.depth",
          {0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5},
          "share of the view distance"},
         {"multires-gather", "multires.normal", {0, 0.05, 0.1, 0.2, 0.3, 0.5, 1, 2}, "range of a component, 0 to 2"}},
        [](Settings&) {},
        [](Settings& s) {
          applyTechnique(s, "rsm");
          s.gather.mode = GatherMode::Full;
        }};
  return {name,
          "clusters of the reflective maps, against every texel of them; both gathered at every pixel",
          {{"hisr", "rsm.tau", {0, 0.001, 0.003, 0.01, 0.02, 0.05, 0.1, 0.3}, "share of the brightest map's light"},
           {"isr", "rsm.depth", {0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5}, "share of the distance"}},
          [](Settings& s) { s.gather.mode = GatherMode::Full; },
          lightByEveryTexel};
}

/// Of the points of one sweep.
Plot plotOf(const nlohmann::json& points, const char* unit) {
  Plot plot;
  plot.title = points[0]["technique"];
  plot.xLabel = points[0]["setting"].get<std::string>() + ", " + unit;
  plot.yLabel = "error, %";
  plot.series = {{"RMSE, share of mean indirect radiance", {}}, {"RMS on the display", {}}};
  for (const nlohmann::json& p : points) {
    if (p["in_use"]) plot.marked = plot.x.size();
    plot.x.push_back(p["value"]);
    plot.series[0].y.push_back(100 * p["rmse_share"].get<double>());
    plot.series[1].y.push_back(100 * p["rms_shown"].get<double>());
  }
  return plot;
}

std::string tableOf(nlohmann::json points, const Settings& settings) {
  const std::string setting = points[0]["setting"];
  const bool standard = settingText(settings, setting) == settingText(Settings{}, setting);
  for (nlohmann::json& p : points) p["use"] = !p["in_use"] ? "" : standard ? "<- default" : "<- as set";
  return tableText({{"technique", "technique"},
                    {"value", setting.c_str()},
                    {"rmse_share", "RMSE, % mean", "%.3f", 100},
                    {"rms_shown", "RMS shown, %", "%.3f", 100},
                    {"bias", "bias, %", "%+.2f", 100},
                    {"gather_ms", "gather, ms", "%.1f"},
                    {"vpls", "VPLs", "%g", 1, "a cut"},
                    {"use", ""}},
                   points);
}

} // namespace

void accuracyCurve(const AccuracyOptions& options) {
  const CurveKind kind = curveKind(options.curve);
  LaunchOptions launch = options.launch;
  // Many VPLs, as the paper, to tell the error of patches from that of VPLs; --set comes after.
  if (kind.name == "patches") launch.set.insert(launch.set.begin(), "rsm.vpls=16384");
  const auto stage = openLaunch(launch);
  needPunctualLight(*stage);
  say(*stage, options.output.quiet);
  const fs::path folder = reportFolder(options.output.out, "out/accuracy");
  GlContext context = GlContext::headless();
  Progress progress("curve of " + kind.name, options.output.quiet);
  RunPlan plan = stillPlan(*stage, progress, Buffer::Indirect);
  stage->settings.effects[EffectId::Redraw] = EffectMode::On;

  Variant every{"truth", stage->settings, stage->seed};
  kind.truth(every.settings);
  const Measured truth = measure({every}, plan)[0];
  if (!(pictureError(truth.picture, truth.picture).meanTruth > 0))
    throw InputError(launch.scene, "no light of reflective shadow maps reaches this view (another view or --point)");
  const Image truthShown = shownImage(truth.picture, truth.exposure);
  writeShown(folder / (kind.name + "-baseline.png"), truthShown);
  plan.frames = 2, plan.skip = 1; // shaders are compiled in the first
  nlohmann::json all = nlohmann::json::array();
  std::vector<Plot> plots;
  std::string tables, pictured;
  for (Sweep sweep : kind.sweeps) {
    Settings settings = stage->settings;
    applyTechnique(settings, sweep.technique);
    kind.prepare(settings);
    const double inUse = std::stod(settingText(settings, sweep.setting));
    if (std::ranges::count(sweep.values, inUse) == 0)
      sweep.values.insert(std::ranges::lower_bound(sweep.values, inUse), inUse);
    std::vector<Variant> variants;
    for (double value : sweep.values)
      applySetting(variants.emplace_back(sweep.technique, settings, stage->seed).settings, sweep.setting,
                   format("%.9g", value));
    nlohmann::json points;
    for (const Measured& m : measure(variants, plan)) {
      const PictureError error = pictureError(m.picture, truth.picture);
      const Image shown = shownImage(m.picture, truth.exposure);
      const double value = sweep.values[points.size()];
      points.push_back({{"technique", sweep.technique},
                        {"setting", sweep.setting},
                        {"value", value},
                        {"in_use", value == inUse},
                        {"rmse_share", error.rmseShare()}, // of the truth's mean indirect radiance
                        {"rms_shown", pictureError(shown, truthShown).rmse},
                        {"bias", error.bias},
                        {"gather_ms", m.ms(StageId::Gather).median},
                        {"vpls", m.frames.back().vplsAlive}}); // 0: each fragment has its own clusters
      if (value != inUse || pictured == sweep.technique) continue;
      pictured = sweep.technique;
      writeShown(folder / (kind.name + "-" + pictured + ".png"), shown);
      writeShown(folder / (kind.name + "-" + pictured + "-difference.png"), absoluteDifference(shown, truthShown, 8));
    }
    all.insert(all.end(), points.begin(), points.end());
    plots.push_back(plotOf(points, sweep.unit));
    tables += tableOf(points, settings) + "\n";
  }
  writeText(folder / (kind.name + ".csv"), csvText(all));
  writeText(folder / (kind.name + ".svg"), svgOf(plots));
  writeJson(options.output.json, {{"points", all}});
  if (!options.output.quiet)
    std::printf("%s, %d x %d\n\n%splot, table and pictures (differences times 8): %s\n", kind.title.c_str(),
                stage->camera.width, stage->camera.height, tables.c_str(), (folder / kind.name).c_str());
}

} // namespace lambent
