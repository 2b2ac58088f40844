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
};

struct CurvePoint {
  double value = 0;
  bool inUse = false;
  double rmseShare = 0; // of the truth's mean indirect radiance
  double rmsShown = 0;  // of values on the display, 0 to 1
  double bias = 0;      // of the mean, share of the truth's
  double gatherMs = 0;
  uint32_t vpls = 0; // 0: each fragment has its own clusters
};

struct Curve {
  Sweep sweep;
  std::vector<CurvePoint> points;
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
    return {name,
            "light gathered at patches of the picture, against the same VPLs gathered at every pixel",
            {{"multires-gather", "multires.depth", {0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5}},
             {"multires-gather", "multires.normal", {0, 0.05, 0.1, 0.2, 0.3, 0.5, 1, 2}}},
            [](Settings&) {},
            [](Settings& s) {
              applyTechnique(s, "rsm");
              s.gather.mode = GatherMode::Full;
            }};
  return {name,
          "clusters of the reflective maps, against every texel of them; both gathered at every pixel",
          {{"hisr", "rsm.tau", {0, 0.001, 0.003, 0.01, 0.02, 0.05, 0.1, 0.3}},
           {"isr", "rsm.depth", {0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5}}},
          [](Settings& s) { s.gather.mode = GatherMode::Full; },
          lightByEveryTexel};
}

double numberOf(const Settings& settings, const std::string& setting) {
  return std::stod(settingText(settings, setting));
}

/// All points of the curves.
nlohmann::json rowsOf(const std::vector<Curve>& curves) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Curve& c : curves)
    for (const CurvePoint& p : c.points)
      rows.push_back({{"technique", c.sweep.technique},
                      {"setting", c.sweep.setting},
                      {"value", p.value},
                      {"in_use", p.inUse},
                      {"rmse_share", p.rmseShare},
                      {"rms_shown", p.rmsShown},
                      {"bias", p.bias},
                      {"gather_ms", p.gatherMs},
                      {"vpls", p.vpls}});
  return rows;
}

std::string csvOf(const nlohmann::json& rows) {
  std::vector<TableColumn> columns;
  for (const char* key :
       {"technique", "setting", "value", "in_use", "rmse_share", "rms_shown", "bias", "gather_ms", "vpls"})
    columns.push_back({key, key});
  return csvText(columns, rows);
}

Plot plotOf(const Curve& curve) {
  Plot plot;
  plot.title = curve.sweep.technique;
  plot.xLabel = curve.sweep.setting;
  plot.yLabel = "error, %";
  plot.series = {{"RMSE, share of mean indirect radiance", {}}, {"RMS on the display", {}}};
  for (const CurvePoint& p : curve.points) {
    if (p.inUse) plot.marked = plot.x.size();
    plot.x.push_back(p.value);
    plot.series[0].y.push_back(100 * p.rmseShare);
    plot.series[1].y.push_back(100 * p.rmsShown);
  }
  return plot;
}

void print(const Curve& curve, const Settings& settings) {
  const bool standard = numberOf(settings, curve.sweep.setting) == numberOf(Settings{}, curve.sweep.setting);
  std::printf("%s\n  %-16s %12s %14s %9s %12s %8s\n", curve.sweep.technique.c_str(), curve.sweep.setting.c_str(),
              "RMSE, % mean", "RMS shown, %", "bias, %", "gather, ms", "VPLs");
  for (const CurvePoint& p : curve.points)
    std::printf("  %-16g %12.3f %14.3f %+9.2f %12.1f %8s%s\n", p.value, 100 * p.rmseShare, 100 * p.rmsShown,
                100 * p.bias, p.gatherMs, p.vpls > 0 ? std::to_string(p.vpls).c_str() : "a cut",
                !p.inUse   ? ""
                : standard ? "  <- default"
                           : "  <- as set");
}

} // namespace

void accuracyCurve(const AccuracyOptions& options) {
  CurveKind kind = curveKind(options.curve);
  LaunchOptions launch = options.launch;
  // Many VPLs, as the paper, to tell the error of patches from that of VPLs; --set comes after.
  if (kind.name == "patches") launch.set.insert(launch.set.begin(), "rsm.vpls=16384");
  const auto stage = openStage(launch);
  needPunctualLight(*stage);
  say(*stage, options.output.quiet);
  const fs::path folder = reportFolder(options.output.out, "out/accuracy");
  GlContext context = GlContext::headless();

  std::vector<Variant> variants{{"truth", stage->settings, stage->seed}};
  kind.truth(variants[0].settings);
  std::vector<Curve> curves;
  for (Sweep& sweep : kind.sweeps) {
    Settings settings = stage->settings;
    applyTechnique(settings, sweep.technique);
    kind.prepare(settings);
    const double inUse = numberOf(settings, sweep.setting);
    sweep.values.insert(std::ranges::lower_bound(sweep.values, inUse), inUse);
    sweep.values.erase(std::unique(sweep.values.begin(), sweep.values.end()), sweep.values.end());
    curves.push_back({sweep, {}});
    for (double value : sweep.values) {
      curves.back().points.push_back({.value = value, .inUse = value == inUse});
      applySetting(variants.emplace_back(sweep.technique, settings, stage->seed).settings, sweep.setting,
                   format("%.9g", value));
    }
  }
  for (Variant& v : variants) v.settings.effects[EffectId::Redraw] = EffectMode::On;
  Image truth;
  float exposure = 1;
  {
    Progress progress("curve of " + kind.name, options.output.quiet);
    RunPlan plan = stillPlan(*stage, progress, Buffer::Indirect);
    const Measured every = measure({variants[0]}, plan)[0];
    truth = every.picture;
    exposure = every.exposure;
    plan.frames = 2, plan.skip = 1; // shaders are compiled in the first
    const Image truthShown = shownImage(truth, exposure);
    if (!(pictureError(truth, truth).meanTruth > 0))
      throw InputError(launch.scene, "no light of reflective shadow maps reaches this view (another view or --point)");
    writeShown(folder / (kind.name + "-baseline.png"), truthShown);
    const std::vector<Measured> runs = measure({variants.begin() + 1, variants.end()}, plan);
    auto run = runs.begin();
    std::string pictured;
    for (Curve& curve : curves)
      for (CurvePoint& p : curve.points) {
        const PictureError error = pictureError(run->picture, truth);
        const Image shown = shownImage(run->picture, exposure);
        p.rmseShare = error.rmseShare();
        p.rmsShown = pictureError(shown, truthShown).rmse;
        p.bias = error.bias;
        p.gatherMs = run->ms(StageId::Gather).median;
        p.vpls = run->frames.back().vplsAlive;
        ++run;
        if (!p.inUse || pictured == curve.sweep.technique) continue;
        pictured = curve.sweep.technique;
        writeShown(folder / (kind.name + "-" + pictured + ".png"), shown);
        writeShown(folder / (kind.name + "-" + pictured + "-difference.png"), absoluteDifference(shown, truthShown, 8));
      }
  }
  const nlohmann::json rows = rowsOf(curves);
  writeText(folder / (kind.name + ".csv"), csvOf(rows));
  std::vector<Plot> plots;
  for (const Curve& c : curves) plots.push_back(plotOf(c));
  writeText(folder / (kind.name + ".svg"), svgOf(plots));
  writeJson(options.output.json, {{"points", rows}});
  if (options.output.quiet) return;
  std::printf("%s, %d x %d\n", kind.title.c_str(), stage->camera.width, stage->camera.height);
  for (const Curve& c : curves) print(c, stage->settings);
  std::printf("plot, table and pictures (differences times 8): %s\n", (folder / kind.name).c_str());
}

} // namespace lambent
