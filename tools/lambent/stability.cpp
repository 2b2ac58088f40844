// lambent stability SHOT...: errors of techniques over time against path-traced truth (paper 1, table 1 and fig. 7), or
// of those from reflective shadow maps against every texel of these (paper 3, fig. 5).
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/runs/runs.h"
#include "gi/reference/traced_picture.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/marks.h"
#include "tools/lambent/reflective_truth.h"
#include "tools/lambent/stability_report.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace lambent {

namespace fs = std::filesystem;

namespace {

struct StabilityOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::vector<std::string> shots, techniques{"smc", "ir", "mir", "tcas"};
  std::string truth = "path";
  int samples = 1024, frames = 0, grid = 16, still = 0, seeds = 1;
  bool quick = false;

  bool pathTraced() const { return truth == "path"; }
};

/// Keeps each seed's, and means over the seeds against the halves of the truth.
void addSeed(ErrorRuns& all, const ErrorRuns& run, int seeds) {
  for (auto error : {&ErrorRuns::error, &ErrorRuns::change}) {
    StatisticRuns& to = all.*error;
    const StatisticRuns& from = run.*error;
    to.seeds.insert(to.seeds.end(), from.seeds.begin(), from.seeds.end());
    to.halves.resize(from.halves.size());
    for (size_t h = 0; h < from.halves.size(); ++h) to.halves[h] += from.halves[h] / seeds;
  }
}

/// Errors are means over the seeds, delays the worst; curves are of the first.
void addSeed(std::vector<TechniqueRun>& techniques, TechniqueRun run, int seeds) {
  for (StabilityErrors* e : {&run.marked, &run.grid})
    for (double* value : {&e->error, &e->change, &e->bias}) *value /= seeds;
  run.placeMs /= seeds;
  const ErrorRuns marked = std::exchange(run.runsMarked, {}), grid = std::exchange(run.runsGrid, {});
  const bool first = techniques.empty() || techniques.back().name != run.name;
  if (first) techniques.push_back(run);
  addSeed(techniques.back().runsMarked, marked, seeds);
  addSeed(techniques.back().runsGrid, grid, seeds);
  if (first) return;
  TechniqueRun& mean = techniques.back();
  for (auto errors : {&TechniqueRun::marked, &TechniqueRun::grid})
    for (auto value : {&StabilityErrors::error, &StabilityErrors::change, &StabilityErrors::bias})
      mean.*errors.*value += run.*errors.*value;
  mean.placeMs += run.placeMs;
  if (run.latency.worstTenth > mean.latency.worstTenth) mean.latency = run.latency;
}

constexpr int kPicturePaths = 32; // per pixel of the picture that shows where the marked pixels are
constexpr int kStillFrames = 6;   // to measure each time at which a shot stands still

bool drawsWholeFrames(const Settings& settings) {
  return settings.own || watchesDirect(settings) || needsOf(settings).reflective() || needsOf(settings).maps;
}

/// The truth first, path traced in two halves, then each technique with each seed.
std::vector<Variant> variantsOf(const StabilityOptions& options, const LaunchContext& stage, const WatchedScene& watched) {
  std::vector<Variant> variants{{"truth", stage.settings, stage.seed}};
  if (options.pathTraced()) {
    variants.push_back({"truth, second half", stage.settings, ~stage.seed});
    for (int half : {0, 1})
      variants[size_t(half)].make = pathsAtPoints(watched, uint32_t(options.samples + 1 - half) / 2);
  } else {
    lightByEveryTexel(variants[0].settings);
  }
  for (const std::string& name : options.techniques)
    for (int k = 0; k < options.seeds; ++k) {
      Variant& v = variants.emplace_back(name, stage.settings, stage.seed + uint32_t(k));
      applyTechnique(v.settings, name);
      if (!drawsWholeFrames(v.settings)) v.make = raysAtPoints(watched);
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
Image markedPicture(LaunchContext& stage, std::span<const vec2> marked, int samples) {
  constexpr int kWidth = 480;
  SceneView view = stage.at(0);
  view.camera.height = std::max(1, view.camera.height * kWidth / view.camera.width);
  view.camera.width = kWidth;
  const TracedPicture traced = tracePicture(
      view, stage.settings,
      {.buffer = ReferenceBuffer::Beauty, .samples = uint32_t(samples), .seed = stage.seed, .cancelled = [] {
         return interrupted.load();
       }});
  if (interrupted) throw RunError("interrupted before there was a result");
  Image shown = shownImage(traced.picture.mean, traced.exposure);
  drawMarks(shown, marked);
  return shown;
}

/// One shot, as it moves or, with `stillAt` (a share of its length), standing still at that time.
ShotRun follow(const StabilityOptions& options, const std::string& file, std::optional<GlContext>& context,
               std::optional<double> stillAt = {}) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  // Placing lights is what is measured; the whole pipeline takes minutes for the comparators, which move every map.
  launch.set.insert(launch.set.begin(), "vpl.visibility=rays");
  const auto stage = openLaunch(launch);
  refuseGlossy(stage->settings);
  if (!stage->shot) throw InputError(file, "not a shot (a .json file)");
  say(*stage, options.output.quiet);

  TrackedPixels tracked = trackedPixels(*stage->shot, options.grid);
  const CameraView camera = stage->at(0).camera;
  for (vec2& p : tracked.points) // what pictures show is seen through the middles of pixels
    p = (glm::floor(p * vec2(camera.width, camera.height)) + 0.5f) / vec2(camera.width, camera.height);
  WatchedScene watched(tracked.points);
  const std::vector<Variant> variants = variantsOf(options, *stage, watched);
  if (!context && std::ranges::any_of(variants, [](const Variant& v) { return drawsWholeFrames(v.settings); }))
    context.emplace(GlContext::headless());
  ShotRun shot;
  shot.name = fs::path(file).stem().string();
  shot.fps = stage->shot->fps;
  shot.marked = tracked.marked;
  Progress progress(shot.name + (stillAt ? " standing still" : ""), options.output.quiet);
  RunPlan plan = planOf(*stage, progress, options.frames);
  StepFinder steps;
  plan.view = [&, length = plan.frames](int frame) {
    const SceneView view = stage->at((stillAt ? *stillAt * length : frame) / shot.fps);
    watched.update(view);
    if (steps.step(view)) shot.steps.push_back(size_t(frame));
    return view;
  };
  if (stillAt) plan.frames = kStillFrames;
  plan.skip = std::min(1, plan.frames - 1); // the first warms up
  plan.points = tracked.points;
  const std::vector<Measured> runs = measure(variants, plan);

  const auto& seen = watched.seen();
  const size_t truths = options.pathTraced() ? 2 : 1;
  const ValueSeries truth = truths > 1 ? joined(runs[0].series, runs[1].series, options.samples) : runs[0].series;
  float exposure = stage->settings.image.exposure;
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
  const auto errorRuns = [&](const PixelSeries& series, const StabilityErrors& whole,
                             std::span<const uint32_t> pixels) {
    ErrorRuns out{{{whole.error}, {}}, {{whole.change}, {}}};
    for (const PixelSeries& half : halves) {
      const StabilityErrors e = stabilityErrors(series, half, pixels);
      out.error.halves.push_back(e.error);
      out.change.halves.push_back(e.change);
    }
    return out;
  };
  for (const Measured& m : std::span(runs).subspan(truths)) {
    TechniqueRun run;
    run.name = m.variant.name;
    run.vpls = needsOf(m.variant.settings).reflective()
                   ? uint32_t(m.of([](const FrameStats& s) { return s.vplsAlive; }).most)
                   : uint32_t(m.variant.settings.smc.vpls);
    run.series = toneMapped(m.series);
    run.marked = stabilityErrors(run.series, shot.truth, marked);
    run.grid = stabilityErrors(run.series, shot.truth, grid);
    run.runsMarked = errorRuns(run.series, run.marked, marked);
    run.runsGrid = errorRuns(run.series, run.grid, grid);
    run.latency = latency90(run.series, shot.truth, grid, shot.steps);
    run.placeMs = m.of([](const FrameStats& s) {
                     double ms = 0;
                     for (const StageTime& t : s.stages) ms += t.cpuMs;
                     return ms;
                   }).median;
    addSeed(shot.techniques, std::move(run), options.seeds);
  }
  if (shot.marked > 0 && !stillAt)
    shot.picture =
        markedPicture(*stage, std::span(tracked.points).first(shot.marked), std::min(options.samples, kPicturePaths));
  return shot;
}

/// Measures the shot at `times` times at which it stands still, in the middles of as many equal parts of its length.
void measureStill(const StabilityOptions& options, const std::string& file, std::optional<GlContext>& context,
                  ShotRun& shot) {
  for (int i = 0; i < options.still; ++i) {
    const ShotRun still = follow(options, file, context, (i + 0.5) / options.still);
    for (size_t t = 0; t < shot.techniques.size(); ++t) {
      shot.techniques[t].stillMarked.error += still.techniques[t].marked.error / options.still;
      shot.techniques[t].stillGrid.error += still.techniques[t].grid.error / options.still;
    }
  }
  shot.still = true;
}

void stability(const StabilityOptions& options) {
  for (const std::string& name : options.techniques) {
    Settings ignored;
    applyTechnique(ignored, name);
  }
  const fs::path folder = reportFolder(options.output.out, "out/stability");
  std::optional<GlContext> context; // made when a shot wants maps
  std::vector<ShotRun> shots;
  for (const std::string& file : options.shots) {
    shots.push_back(follow(options, file, context));
    if (options.still > 0 && shots.back().steps.empty()) measureStill(options, file, context, shots.back());
  }

  std::string conditions = "Truth: every texel of the reflective shadow maps at every pixel";
  if (options.pathTraced()) {
    conditions =
        format("Truth: path tracing with %d paths per pixel; standard error of its values (tone-mapped luminance):",
               options.samples);
    for (const ShotRun& s : shots)
      conditions += format("%s %.4f in ", &s == shots.data() ? "" : ",", s.truthError) + s.name;
  }
  conditions += ". " + std::to_string(options.grid * options.grid) + " grid pixels, " +
                std::to_string(shots.front().truth.size()) + " frames of the first shot";
  conditions += options.seeds > 1 ? ", means over " + std::to_string(options.seeds) + " seeds." : ".";
  const nlohmann::json figures = stabilityFigures(shots);
  writeStabilityReport(folder, shots, figures, conditions);
  writeJson(options.output.json, figures);
  if (!options.output.quiet)
    std::printf("%s%s\n%sreport: %s\n", stabilityTable(figures).c_str(), conditions.c_str(),
                stabilityRankings(shots).c_str(), (folder / "stability.md").c_str());
}

} // namespace

void declareStability(CLI::App& app) {
  auto options = std::make_shared<StabilityOptions>();
  CLI::App* command = app.add_subcommand("stability", "errors of techniques over the frames of shots, against truth");
  command->add_option("SHOT", options->shots, "shot files (.json)")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output, "folder for the report (default out/stability)");
  command->add_option("--techniques", options->techniques, "comma-separated (default smc,ir,mir,tcas)")->delimiter(',');
  command
      ->add_option(
          "--truth", options->truth,
          "path: path tracing (default); reflective: every texel of the reflective shadow maps at every pixel, "
          "which rsm, isr, hisr and the multires techniques approximate")
      ->check(CLI::IsMember({"path", "reflective"}));
  command->add_option("--spp", options->samples, "paths per pixel and frame of the truth (default 1024)")
      ->check(CLI::Range(4, 1 << 24)); // two halves, of two or more each
  command->add_option("--frames", options->frames, "only the first so many of each shot")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--grid", options->grid, "grid of so many by so many pixels besides the marked (default 16)")
      ->check(CLI::Range(1, 256));
  command
      ->add_option("--still", options->still,
                   "also at so many times at which the shot stands still, for |E| over still")
      ->check(CLI::Range(0, 1000));
  command
      ->add_option(
          "--seeds", options->seeds,
          "errors are means over so many seeds (default 1; two or more tell how well they are known, and rank)")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--quick", options->quick, "few pixels, frames and paths, to try whether it runs");
  command->callback([options] {
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
