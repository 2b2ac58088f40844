// lambent stability SHOT...: errors of techniques over time against path-traced truth (paper 1, table 1 and fig. 7), or
// of those from reflective shadow maps against every texel of these (paper 3, fig. 5).
#include "engine/core/error.h"
#include "engine/image/exposure.h"
#include "gi/plan/techniques.h"
#include "tools/lambent/picture.h"
#include "tools/lambent/plot.h"
#include "tools/lambent/stability_report.h"
#include "tools/lambent/study.h"

#include <algorithm>
#include <cmath>
#include <ranges>

namespace lambent {

namespace fs = std::filesystem;

namespace {

struct StabilityOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::vector<std::string> shots, techniques{"smc", "ir", "mir", "tcas"};
  std::string truth = "path", protocol = "rays";
  int samples = 1024, frames = 0, grid = 16, still = 0, seeds = 1;
  bool quick = false;

  bool pathTraced() const { return truth == "path"; }
};

/// What one seed's series adds to the means over `seeds`, and to what is known of them.
void addErrors(GroupErrors& to, const PixelSeries& series, const PixelSeries& truth,
               const std::vector<PixelSeries>& halves, std::span<const uint32_t> pixels, int seeds) {
  const StabilityErrors e = stabilityErrors(series, truth, pixels);
  to.mean.error += e.error / seeds;
  to.mean.change += e.change / seeds;
  to.mean.bias += e.bias / seeds;
  to.error.seeds.push_back(e.error);
  to.change.seeds.push_back(e.change);
  to.error.halves.resize(halves.size());
  to.change.halves.resize(halves.size());
  for (size_t h = 0; h < halves.size(); ++h) {
    const StabilityErrors half = stabilityErrors(series, halves[h], pixels);
    to.error.halves[h] += half.error / seeds;
    to.change.halves[h] += half.change / seeds;
  }
  if (halves.empty()) return;
  addNoisyErrors(to.noisyError, ErrorKind::Error, series, truth, halves[0], halves[1], pixels);
  addNoisyErrors(to.noisyChange, ErrorKind::Change, series, truth, halves[0], halves[1], pixels);
}

/// How techniques are drawn while they are compared.
struct Protocol {
  const char *name, *help;
  Assignments set;
};
const Protocol kProtocols[] = {
    {"rays", "sets of lights alone, a ray for every pixel and light (default)", {{"vpl.visibility", "rays"}}},
    {"paper", "as paper 1: maps, 4x4 subsets, filter, each frame by itself, one clamp for all, no near light",
     asInPaper1()},
    {"frames", "frames as they are drawn otherwise", {}},
};
const Protocol& protocolOf(const StabilityOptions& options) {
  return *std::ranges::find(kProtocols, options.protocol, &Protocol::name);
}

constexpr int kPicturePaths = 32; // per pixel of the picture that shows where the marked pixels are
constexpr int kStillFrames = 6;   // to measure each time at which a shot stands still

bool drawsWholeFrames(const Settings& settings) {
  return settings.own || watchesDirect(settings) || needsOf(settings).reflective() || needsOf(settings).maps;
}

/// The truth first, path traced in two halves, then each technique with each seed.
std::vector<Variant> variantsOf(const StabilityOptions& options, const LaunchContext& opened,
                                const WatchedScene& watched) {
  std::vector<Variant> variants{variantOf(opened, "truth")};
  if (options.pathTraced()) {
    variants.push_back({"truth, second half", opened.settings, ~opened.seed});
    for (int half : {0, 1})
      variants[size_t(half)].make = pathsAtPoints(watched, uint32_t(options.samples + 1 - half) / 2);
  } else {
    lightByEveryTexel(variants[0].settings);
  }
  for (const std::string& name : options.techniques)
    for (Variant& v : seeded({variantOf(opened, name, {}, name)}, options.seeds)) {
      if (!drawsWholeFrames(v.settings)) v.make = raysAtPoints(watched);
      variants.push_back(std::move(v));
    }
  return variants;
}

using ValueSeries = std::vector<std::vector<TrackedValue>>; // [frame][point]

/// The mean of two independent ones, of `samples` in all.
ValueSeries joined(ValueSeries a, const ValueSeries& b, int samples) {
  const float ofA = float((samples + 1) / 2) / float(samples), ofB = 1 - ofA;
  for (size_t f = 0; f < a.size(); ++f)
    for (size_t i = 0; i < a[f].size(); ++i) {
      const vec3 errorA = ofA * a[f][i].error, errorB = ofB * b[f][i].error;
      a[f][i] = {ofA * a[f][i].radiance + ofB * b[f][i].radiance, glm::sqrt(errorA * errorA + errorB * errorB)};
    }
  return a;
}

/// The first frame, path traced, with the marked pixels numbered.
Image markedPicture(LaunchContext& opened, std::span<const vec2> marked, int samples) {
  constexpr int kWidth = 480;
  SceneView view = opened.at(0);
  view.camera.height = std::max(1, view.camera.height * kWidth / view.camera.width);
  view.camera.width = kWidth;
  const TracedImage traced =
      trace(view, opened.settings,
            {.buffer = ReferenceBuffer::Beauty, .samples = uint32_t(samples), .seed = opened.seed}, "", true);
  if (interrupted) throw RunError("interrupted before there was a result");
  Image shown = shownImage(traced.image.mean, traced.exposure);
  drawMarks(shown, marked);
  return shown;
}

/// One shot, as it moves or, with `stillAt` (a share of its length), standing still at that time.
ShotRun follow(const StabilityOptions& options, const std::string& file, const fs::path& folder,
               std::optional<GlContext>& context, std::optional<double> stillAt = {}) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  for (const auto& [name, value] : protocolOf(options).set | std::views::reverse)
    launch.set.insert(launch.set.begin(), name + "=" + value); // --set comes after it
  launch.set.insert(launch.set.begin(), kLambertReceivers);
  const auto opened = openLaunch(launch);
  refuseGlossy(opened->settings);
  if (!opened->shot) throw InputError(file, "not a shot (a .json file)");
  checkStabilityResults(folder, nameOf(file)); // again: what the shot reads is known now
  say(*opened, options.output.quiet);

  TrackedPixels tracked = trackedPixels(*opened->shot, options.grid);
  const CameraView camera = opened->at(0).camera;
  for (vec2& p : tracked.points) // what pictures show is seen through the middles of pixels
    p = (glm::floor(p * vec2(camera.width, camera.height)) + 0.5f) / vec2(camera.width, camera.height);
  WatchedScene watched(tracked.points);
  const std::vector<Variant> variants = variantsOf(options, *opened, watched);
  if (!context && std::ranges::any_of(variants, [](const Variant& v) { return drawsWholeFrames(v.settings); }))
    context.emplace(GlContext::headless());
  ShotRun shot;
  shot.name = nameOf(file);
  shot.protocol = options.protocol;
  for (const auto& [name, value] : protocolOf(options).set)
    shot.set += (shot.set.empty() ? "" : ", ") + name + "=" + settingText(opened->settings, name);
  shot.fps = opened->shot->fps;
  shot.marked = tracked.marked;
  RunPlan plan = planOf(*opened, options.frames);
  StepFinder steps;
  plan.view = watchedBy(watched, [&, length = plan.frames](int frame) {
    const SceneView view = opened->at((stillAt ? *stillAt * length : frame) / shot.fps);
    if (steps.step(view)) shot.steps.push_back(size_t(frame));
    return view;
  });
  if (stillAt) plan.frames = kStillFrames;
  plan.skip = std::min(1, plan.frames - 1); // the first warms up
  plan.points = tracked.points;
  const std::vector<Measured> runs =
      run(variants, plan, shot.name + (stillAt ? " standing still" : ""), options.output.quiet);

  const auto& seen = watched.seen();
  const size_t truths = options.pathTraced() ? 2 : 1;
  const ValueSeries truth = truths > 1 ? joined(runs[0].series, runs[1].series, options.samples) : runs[0].series;
  float exposure = opened->settings.image.exposure;
  if (exposure <= 0) {
    std::vector<vec3> first;
    for (const TrackedValue& v : truth[0]) first.push_back(v.radiance);
    exposure = exposureFor(first);
  }
  const auto toneMapped = [&](const ValueSeries& series) { return toneMappedSeries(series, seen, exposure); };
  double variance = 0;
  size_t values = 0;
  for (size_t f = 0; f < truth.size(); ++f)
    for (size_t i = 0; i < truth[f].size(); ++i)
      if (seen[f][i]) variance += toneMappedVariance(truth[f][i].radiance, truth[f][i].error, exposure), ++values;
  shot.truthError = values ? std::sqrt(variance / double(values)) : 0;
  shot.truth = toneMapped(truth);
  std::vector<PixelSeries> halves;
  for (size_t h = 0; h < truths && truths > 1; ++h) halves.push_back(toneMapped(runs[h].series));
  std::vector<uint32_t> marked, grid;
  for (uint32_t i = 0; i < tracked.points.size(); ++i) (i < shot.marked ? marked : grid).push_back(i);
  for (size_t i = truths; i < runs.size(); i += size_t(options.seeds)) {
    const Settings& settings = runs[i].variant.settings;
    TechniqueRun& technique = shot.techniques.emplace_back(runs[i].variant.name, uint32_t(settings.smc.vpls));
    if (needsOf(settings).reflective())
      technique.vpls = uint32_t(runs[i].of([](const FrameStats& s) { return s.vplsAlive; }).most);
    for (const Measured& m : std::span(runs).subspan(i, size_t(options.seeds))) {
      const PixelSeries series = toneMapped(m.series);
      addErrors(technique.marked, series, shot.truth, halves, marked, options.seeds);
      addErrors(technique.grid, series, shot.truth, halves, grid, options.seeds);
      const Latency latency = latency90(series, shot.truth, grid, shot.steps);
      if (&m == &runs[i] || latency.worstTenth > technique.latency.worstTenth) technique.latency = latency;
      if (&m == &runs[i]) technique.series = series;
      const auto placeMs = [](const FrameStats& s) {
        double ms = 0;
        for (const StageTime& t : s.stages) ms += t.cpuMs;
        return ms;
      };
      technique.placeMs += m.of(placeMs).median / options.seeds;
    }
  }
  if (shot.marked > 0 && !stillAt)
    shot.image =
        markedPicture(*opened, std::span(tracked.points).first(shot.marked), std::min(options.samples, kPicturePaths));
  return shot;
}

/// Measures the shot at `times` times at which it stands still, in the middles of as many equal parts of its length.
void measureStill(const StabilityOptions& options, const std::string& file, const fs::path& folder,
                  std::optional<GlContext>& context, ShotRun& shot) {
  for (int i = 0; i < options.still; ++i) {
    const ShotRun still = follow(options, file, folder, context, (i + 0.5) / options.still);
    for (size_t t = 0; t < shot.techniques.size(); ++t) {
      shot.techniques[t].marked.still += still.techniques[t].marked.mean.error / options.still;
      shot.techniques[t].grid.still += still.techniques[t].grid.mean.error / options.still;
    }
  }
  shot.still = true;
}

void stability(const StabilityOptions& options) {
  for (const std::string& name : options.techniques) techniqueByName(name); // or a guess at what was meant
  refuseNamesakes(options.shots);
  const fs::path folder = reportFolder(options.output, "out/stability", {});
  for (const std::string& file : options.shots) checkStabilityResults(folder, nameOf(file));
  std::optional<GlContext> context; // made when a shot wants maps
  std::vector<ShotRun> shots;
  for (const std::string& file : options.shots) {
    shots.push_back(follow(options, file, folder, context));
    if (options.still > 0 && shots.back().steps.empty()) measureStill(options, file, folder, context, shots.back());
  }

  const std::string& set = shots.front().set;
  std::string conditions = "Protocol: " + options.protocol + (set.empty() ? "" : " (" + set + ")") + ". ";
  if (!options.pathTraced()) {
    conditions += "Truth: every texel of the reflective shadow maps at every pixel";
  } else {
    conditions +=
        format("Truth: path tracing with %d paths per pixel; standard error of its values (tone-mapped luminance):",
               options.samples);
    for (const ShotRun& s : shots)
      conditions += format("%s %.4f in ", &s == shots.data() ? "" : ",", s.truthError) + s.name;
  }
  conditions += format(". %d grid pixels, %zu frames of the first shot", options.grid * options.grid,
                       shots.front().truth.size()) +
                (options.seeds > 1 ? format(", means over %d seeds.", options.seeds) : ".");
  writeStabilityReport(options.output, folder, shots, conditions);
}

} // namespace

void declareStability(CLI::App& app) {
  auto options = std::make_shared<StabilityOptions>();
  Command command(app, "stability", "errors of techniques over the frames of shots, against truth");
  command.reads("SHOT", options->shots, "shot files (.json)", true);
  command.launch(options->launch);
  command.output(options->output, "folder for the report (default out/stability)");
  command.list("--techniques", options->techniques, "comma-separated (default smc,ir,mir,tcas)");
  command.choice("--truth", options->truth, {"path", "reflective"},
                 "path: path tracing (default); reflective: every texel of the reflective shadow maps at every pixel, "
                 "which rsm, isr, hisr and the multires techniques approximate");
  std::vector<std::string> protocols;
  std::string help;
  for (const Protocol& p : kProtocols) {
    protocols.push_back(p.name);
    help += (help.empty() ? "" : "; ") + std::string(p.name) + ": " + p.help;
  }
  command.choice("--protocol", options->protocol, protocols, help + "; --set changes single settings of it");
  command.number("--spp", &options->samples, 4, 1 << 24, // two halves, of two or more each
                 "paths per pixel and frame of the truth (default 1024)");
  command.number("--frames", &options->frames, 1, 1000000, "only the first so many of each shot");
  command.number("--grid", &options->grid, 1, 256, "grid of so many by so many pixels besides the marked (default 16)");
  command.number("--still", &options->still, 0, 1000,
                 "also at so many times at which the shot stands still, for |E| over still");
  command.number("--seeds", &options->seeds, 1, 1000,
                 "errors are means over so many seeds (default 1; two or more tell how well they are known, and rank)");
  command.flag("--quick", options->quick, "few pixels, frames and paths, to try whether it runs");
  command.run([options] {
    if (options->quick) {
      options->samples = std::min(options->samples, 16);
      options->grid = std::min(options->grid, 4);
      if (options->frames == 0) options->frames = 3;
      if (options->launch.size.empty()) options->launch.size = "48x27";
    }
    stability(*options);
  });
}

} // namespace lambent
