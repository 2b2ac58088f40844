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
#include <optional>

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

double gatherMs(const FrameStats& stats) {
  double ms = 0;
  for (const StageTime& t : stats.stages)
    if (t.stage == key(StageId::Gather)) ms += std::max(t.cpuMs, t.gpuMs);
  return ms;
}

/// Pictures of one view under changing settings.
class Painter {
 public:
  Painter(Stage& stage, const CurveKind& kind) : stage_(stage), kind_(kind), gi_(stage.settings, stage.seed) {}

  Settings settingsFor(const std::string& technique) const {
    Settings s = stage_.settings;
    applyTechnique(s, technique);
    kind_.prepare(s);
    return s;
  }

  Image truth() {
    Settings s = stage_.settings;
    kind_.truth(s);
    return draw(s);
  }

  /// Indirect radiance.
  Image draw(Settings settings) {
    settings.effects[EffectId::Redraw] = EffectMode::On;
    if (settings.debug.timing == TimingMode::Auto) settings.debug.timing = TimingMode::Finish;
    gi_.settings() = settings;
    stats_ = gi_.run(stage_.at(0));
    return gi_.read(Buffer::Indirect);
  }

  const FrameStats& stats() const { return stats_; }
  float exposure() const { return gi_.exposure(); }

 private:
  Stage& stage_;
  const CurveKind& kind_;
  GiFrame gi_;
  FrameStats stats_;
};

std::string csvOf(const std::vector<Curve>& curves) {
  std::string out = "technique,setting,value,in_use,rmse_share,rms_shown,bias,gather_ms,vpls\n";
  for (const Curve& c : curves)
    for (const CurvePoint& p : c.points)
      out += c.sweep.technique + "," + c.sweep.setting +
             format(",%g,%d,%.6g,%.6g,%.6g,%.3f,%u\n", p.value, int(p.inUse), p.rmseShare, p.rmsShown, p.bias,
                    p.gatherMs, p.vpls);
  return out;
}

nlohmann::json figuresOf(const std::vector<Curve>& curves) {
  nlohmann::json j;
  for (const Curve& c : curves)
    for (const CurvePoint& p : c.points)
      j["points"].push_back({{"technique", c.sweep.technique},
                             {"setting", c.sweep.setting},
                             {"value", p.value},
                             {"in_use", p.inUse},
                             {"rmse_share", p.rmseShare},
                             {"rms_shown", p.rmsShown},
                             {"bias", p.bias},
                             {"gather_ms", p.gatherMs},
                             {"vpls", p.vpls}});
  return j;
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

/// |a − b| on the display, eight times.
Image magnifiedDifference(const Image& a, const Image& b) {
  constexpr float kFactor = 8;
  Image out = a;
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = kFactor * glm::abs(a.pixels[i] - b.pixels[i]);
  return out;
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

  size_t total = 1;
  for (Sweep& sweep : kind.sweeps) {
    const double inUse = numberOf(stage->settings, sweep.setting);
    sweep.values.insert(std::ranges::lower_bound(sweep.values, inUse), inUse);
    sweep.values.erase(std::unique(sweep.values.begin(), sweep.values.end()), sweep.values.end());
    total += sweep.values.size() + 1;
  }
  std::vector<Curve> curves;
  {
    Painter painter(*stage, kind);
    Progress progress("curve of " + kind.name, options.output.quiet);
    size_t done = 0;
    const auto step = [&] {
      if (interrupted) throw RunError("interrupted: nothing is written");
      progress.update(int(++done), int(total));
    };
    const Image truth = painter.truth();
    if (!(meanOf(truth) > 0))
      throw InputError(launch.scene, "no light of reflective shadow maps reaches this view (another view or --point)");
    const float exposure = painter.exposure();
    const Image truthShown = shownImage(truth, exposure);
    writeShown(folder / (kind.name + "-baseline.png"), truthShown);
    step();
    std::string pictured;
    for (const Sweep& sweep : kind.sweeps) {
      const Settings settings = painter.settingsFor(sweep.technique);
      const Image asSet = shownImage(painter.draw(settings), exposure); // shaders are compiled after this
      step();
      if (pictured != sweep.technique) {
        pictured = sweep.technique;
        writeShown(folder / (kind.name + "-" + pictured + ".png"), asSet);
        writeShown(folder / (kind.name + "-" + pictured + "-difference.png"), magnifiedDifference(asSet, truthShown));
      }
      curves.push_back({sweep, {}});
      for (double value : sweep.values) {
        Settings changed = settings;
        applySetting(changed, sweep.setting, format("%.9g", value));
        const Image picture = painter.draw(changed);
        curves.back().points.push_back({.value = value,
                                        .inUse = value == numberOf(settings, sweep.setting),
                                        .rmseShare = rmseShare(picture, truth),
                                        .rmsShown = rmse(shownImage(picture, exposure), truthShown),
                                        .bias = meanOf(picture) / meanOf(truth) - 1,
                                        .gatherMs = gatherMs(painter.stats()),
                                        .vpls = painter.stats().vplsAlive});
        step();
      }
    }
  }
  writeText(folder / (kind.name + ".csv"), csvOf(curves));
  std::vector<Plot> plots;
  for (const Curve& c : curves) plots.push_back(plotOf(c));
  writeText(folder / (kind.name + ".svg"), svgOf(plots));
  writeJson(options.output.json, figuresOf(curves));
  if (options.output.quiet) return;
  std::printf("%s, %d x %d\n", kind.title.c_str(), stage->camera.width, stage->camera.height);
  for (const Curve& c : curves) print(c, stage->settings);
  std::printf("plot, table and pictures (differences times 8): %s\n", (folder / kind.name).c_str());
}

} // namespace lambent
