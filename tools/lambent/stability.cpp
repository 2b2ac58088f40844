// lambent stability SHOT...: errors of techniques over time against path-traced truth (paper 1, table 1 and fig. 7), or
// of those from reflective shadow maps against every texel of these (paper 3, fig. 5).
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/trace/embree_query.h"
#include "gi/reference/path_tracer.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/follower.h"
#include "tools/lambent/reflective_truth.h"
#include "tools/lambent/text.h"
#include "tools/lambent/tracked_pixels.h"

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
  bool check = false;

  bool pathTraced() const { return truth == "path"; }
};

/// Frames in which some light differs from the frame before by half or more, or some object jumps.
class StepFinder {
 public:
  bool step(const SceneView& view) {
    bool found = false;
    for (const InstanceView& i : view.instances) found |= jumped(i, view.assets->meshes[i.mesh].boundsObject);
    std::vector<float> now;
    for (const LightView& l : view.lights) now.push_back(luminance(l.intensity));
    for (size_t i = 0; i < now.size() && now.size() == before_.size(); ++i)
      found |= std::min(now[i], before_[i]) < 0.5f * std::max(now[i], before_[i]);
    before_ = std::move(now);
    return found;
  }

 private:
  std::vector<float> before_;
};

/// log-average luminance of the surfaces at the tracked points in the first frame to 0.18, as GiFrame measures a
/// picture.
float exposureOf(const std::vector<vec3>& radiance) {
  double sum = 0;
  size_t count = 0;
  for (const vec3& r : radiance)
    if (luminance(r) > 0) sum += std::log(double(luminance(r))), ++count;
  return count ? float(0.18 / std::exp(sum / double(count))) : 1.0f;
}

/// Variance of the tone-mapped luminance, by its derivative 1/(1+x)², as if channels were fully correlated.
double toneMappedVariance(const TrackedValue& value, float exposure) {
  const double x = exposure * luminance(value.radiance);
  const double e = exposure * luminance(value.error) / ((1 + x) * (1 + x));
  return e * e;
}

/// Errors are means over the seeds, delays the worst; curves are of the first.
void addSeed(std::vector<TechniqueRun>& techniques, TechniqueRun run, int seeds) {
  for (StabilityErrors* e : {&run.marked, &run.grid})
    for (double* value : {&e->error, &e->change, &e->bias}) *value /= seeds;
  run.placeMs /= seeds;
  if (techniques.empty() || techniques.back().name != run.name) {
    techniques.push_back(std::move(run));
    return;
  }
  TechniqueRun& mean = techniques.back();
  for (auto errors : {&TechniqueRun::marked, &TechniqueRun::grid})
    for (auto value : {&StabilityErrors::error, &StabilityErrors::change, &StabilityErrors::bias})
      mean.*errors.*value += run.*errors.*value;
  mean.placeMs += run.placeMs;
  if (run.latency.worstTenth > mean.latency.worstTenth) mean.latency = run.latency;
}

constexpr int kStillFrames = 6; // to measure each time at which a shot stands still

/// One shot, as it moves or, with `stillAt` (a share of its length), standing still at that time.
ShotRun follow(const StabilityOptions& options, const std::string& file, std::optional<GlContext>& context,
               std::optional<double> stillAt = {}) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  // Placing lights is what is measured; the whole pipeline takes minutes for the comparators, which move every map.
  launch.set.insert(launch.set.begin(), "vpl.visibility=rays");
  const auto stage = openStage(launch);
  refuseGlossy(stage->settings);
  if (!stage->shot) throw InputError(file, "not a shot (a .json file)");
  say(*stage, options.output.quiet);

  const TrackedPixels tracked = trackedPixels(*stage->shot, options.grid);
  const std::vector<vec2>& points = tracked.points;
  ShotRun shot;
  shot.name = fs::path(file).stem().string();
  shot.fps = stage->shot->fps;
  shot.marked = tracked.marked;
  std::vector<uint32_t> marked, grid;
  for (uint32_t i = 0; i < points.size(); ++i) (i < shot.marked ? marked : grid).push_back(i);

  std::vector<std::unique_ptr<Follower>> followers;
  for (const std::string& name : options.techniques)
    for (int k = 0; k < options.seeds; ++k) {
      Settings settings = stage->settings;
      applyTechnique(settings, name);
      followers.push_back(std::make_unique<Follower>(settings, name, stage->seed + uint32_t(k), context));
    }
  std::optional<Follower> everyTexel;
  if (!options.pathTraced()) {
    Settings settings = stage->settings;
    lightByEveryTexel(settings);
    everyTexel.emplace(settings, "truth", stage->seed, context);
  }
  std::unique_ptr<EmbreeQuery> rays;
  StepFinder steps;
  std::vector<PixelSums> sums;
  float exposure = stage->settings.image.exposure;
  double variance = 0;
  size_t values = 0;
  const int length =
      options.frames > 0 ? std::min(options.frames, stage->shot->frameCount()) : stage->shot->frameCount();
  const int total = stillAt ? kStillFrames : length;
  Progress progress(shot.name + (stillAt ? " standing still" : ""), options.output.quiet);
  for (int f = 0; f < total && !interrupted; ++f) {
    const SceneView view = stage->at((stillAt ? *stillAt * length : f) / stage->shot->fps);
    if (!rays) rays = std::make_unique<EmbreeQuery>(*view.assets);
    rays->update(view);
    const LightSet lights = collectLights(view);
    if (steps.step(view)) shot.steps.push_back(size_t(f));
    const std::vector<SurfaceHit> surfaces = surfacesAt(*rays, view.camera, points);
    RayCounts counts;
    if (options.pathTraced() && (!stillAt || f == 0))
      sums = sampleSurfaces(surfaces, {*rays, lights, view.camera, stage->settings.smc.bounces, 0, stage->seed},
                            uint32_t(options.samples), counts);
    std::vector<TrackedValue> known;
    std::vector<vec3> truth;
    for (size_t i = 0; i < sums.size(); ++i) {
      known.push_back(trackedValue(sums[i], surfaces[i], uint32_t(options.samples)));
      truth.push_back(known.back().radiance);
    }
    if (everyTexel) truth = everyTexel->frame(view, *rays, lights, points, surfaces);
    if (exposure <= 0) exposure = exposureOf(truth);
    const auto toneMapped = [&](const std::vector<vec3>& radiance) {
      std::vector<float> out;
      for (size_t i = 0; i < radiance.size(); ++i)
        out.push_back(surfaces[i].valid() ? toneMappedLuminance(radiance[i], exposure) : std::nanf(""));
      return out;
    };
    shot.truth.push_back(toneMapped(truth));
    for (size_t i = 0; i < sums.size(); ++i)
      if (surfaces[i].valid()) variance += toneMappedVariance(known[i], exposure), ++values;
    for (auto& follower : followers)
      follower->run.series.push_back(toneMapped(follower->frame(view, *rays, lights, points, surfaces)));
    progress.update(f + 1, total);
  }
  if (interrupted) throw RunError("interrupted: nothing is written");
  shot.truthError = values ? std::sqrt(variance / double(values)) : 0;
  for (auto& follower : followers) {
    TechniqueRun& run = follower->run;
    run.marked = stabilityErrors(run.series, shot.truth, marked);
    run.grid = stabilityErrors(run.series, shot.truth, grid);
    run.latency = latency90(run.series, shot.truth, grid, shot.steps);
    run.placeMs = follower->medianPlaceMs();
    addSeed(shot.techniques, std::move(run), options.seeds);
  }
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

/// Throws RunError unless smc's error is at most 1.25 times what it is while the scene stands still, and steps are
/// followed within six frames.
void checkFollows(const std::vector<ShotRun>& shots) {
  constexpr double kMostOverStill = 1.25, kMostFrames = 6, kLeastFollowed = 0.8;
  std::string failures;
  const auto fail = [&](const std::string& what) { failures += (failures.empty() ? "" : "; ") + what; };
  for (const ShotRun& s : shots) {
    const TechniqueRun* smc = s.technique("smc");
    if (!smc) throw InputError("--check", "needs smc (--techniques)");
    // Over all tracked pixels: that of the few marked ones alone scatters by a tenth from seed to seed.
    const double marked = double(s.marked), grid = double(s.truth.front().size()) - marked;
    const auto all = [&](const StabilityErrors& m, const StabilityErrors& g) {
      return marked * m.error + grid * g.error;
    };
    if (s.still && !(all(smc->marked, smc->grid) <= kMostOverStill * all(smc->stillMarked, smc->stillGrid)))
      fail("|E| grows too much with motion in " + s.name);
    if (!s.steps.empty() &&
        !(smc->latency.count > 0 && smc->latency.worstTenth <= kMostFrames && smc->latency.followed >= kLeastFollowed))
      fail("steps are followed too late or not wholly in " + s.name);
  }
  if (!failures.empty()) throw RunError("smc: " + failures);
}

/// Throws RunError unless smc changes its error least in every shot and follows steps of the light within two frames.
void checkSteadiest(const std::vector<ShotRun>& shots) {
  std::string failures;
  for (const ShotRun& s : shots) {
    const TechniqueRun* smc = s.technique("smc");
    if (smc && smc->latency.worstTenth > 2)
      throw RunError("smc follows the light in " + s.name + " only after " +
                     std::to_string(int(smc->latency.worstTenth)) + " frames");
    for (const TechniqueRun& t : s.techniques)
      if (!smc || (t.name != "smc" && !(smc->grid.change < t.grid.change)))
        failures += (failures.empty() ? "" : ", ") + t.name + " in " + s.name;
  }
  if (!failures.empty()) throw RunError("smc is not steadier than " + failures);
}

void stability(const StabilityOptions& options) {
  for (const std::string& name : options.techniques) {
    Settings ignored;
    applyTechnique(ignored, name);
  }
  if (options.check && options.still == 0 && options.techniques.size() < 2)
    throw InputError("--check", "needs smc and others (--techniques), or --still");
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
  writeStabilityReport(folder, shots, conditions);
  nlohmann::json figures = nlohmann::json::array();
  for (const ShotRun& s : shots)
    for (const TechniqueRun& t : s.techniques) {
      figures.push_back({{"shot", s.name},
                         {"technique", t.name},
                         {"vpls", t.vpls},
                         {"error_marked", t.marked.error},
                         {"change_marked", t.marked.change},
                         {"error_grid", t.grid.error},
                         {"change_grid", t.grid.change},
                         {"bias_grid", t.grid.bias},
                         {"l90_median", t.latency.median},
                         {"l90_worst_tenth", t.latency.worstTenth},
                         {"l90_followed", t.latency.followed},
                         {"l90_count", t.latency.count},
                         {"truth_error", s.truthError}});
      if (!s.still) continue;
      figures.back()["error_still_marked"] = t.stillMarked.error;
      figures.back()["error_still_grid"] = t.stillGrid.error;
    }
  writeJson(options.output.json, figures);
  if (!options.output.quiet)
    std::printf("%s%s\nreport: %s\n", stabilityTable(shots).c_str(), conditions.c_str(),
                (folder / "stability.html").c_str());
  if (options.check) (options.still > 0 ? checkFollows : checkSteadiest)(shots);
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
      ->check(CLI::Range(2, 1 << 24));
  command->add_option("--frames", options->frames, "only the first so many of each shot")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--grid", options->grid, "grid of so many by so many pixels besides the marked (default 16)")
      ->check(CLI::Range(1, 256));
  command
      ->add_option("--still", options->still,
                   "also at so many times at which the shot stands still, for |E| over still")
      ->check(CLI::Range(0, 1000));
  command->add_option("--seeds", options->seeds, "errors are means over so many seeds (default 1)")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--check", options->check,
                    "exit with 1 unless smc has the smallest |E'| (grid) in every shot and L90 of two frames at most; "
                    "with --still, unless |E| of smc (all tracked pixels) is at most 1.25 times the still one, and L90 "
                    "six frames at most");
  command->callback([options] { stability(*options); });
}

} // namespace lambent
