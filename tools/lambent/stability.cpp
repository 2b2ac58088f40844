// lambent stability SHOT...: errors of techniques over time against path-traced truth (paper 1, table 1 and fig. 7), or
// of those from reflective shadow maps against every texel of these (paper 3, fig. 5).
#include "gi/measure/stability.h"
#include "engine/core/error.h"
#include "gi/measure/statistics.h"
#include "gi/plan/techniques.h"
#include "tools/lambent/picture.h"
#include "tools/lambent/plot.h"
#include "tools/lambent/study.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

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

/// Errors of one technique at some of the watched pixels.
struct GroupErrors {
  StabilityErrors mean; // over the seeds
  StatisticRuns error,
      change;       // |E| and |E'| of each seed, and against halves of the truth: what rankings are made from
  double still = 0; // |E| of the same views standing still, where ShotRun::still is set
};

/// One technique over one shot.
struct TechniqueRun {
  std::string name;
  uint32_t vpls = 0;       // N; those of most in a frame where it varies; 0: every pixel has its own clusters
  PixelSeries series = {}; // of the first seed
  GroupErrors marked = {}, grid = {};
  Latency latency = {}; // the worst of the seeds
  double placeMs = 0;   // median time per frame of placing virtual lights, mean over the seeds
};

/// One shot. The first `marked` pixels are the shot's own, the others its grid.
struct ShotRun {
  std::string name;
  double fps = 30;
  size_t marked = 0;
  PixelSeries truth;
  std::vector<size_t> steps; // frames in which the scene changes by a step
  bool still = false;        // also measured standing still
  double truthError = 0;     // standard error of a value of the truth, RMS, tone-mapped luminance
  Image image; // values of the display: the first frame, with the marked pixels numbered; empty: none are marked
  std::vector<TechniqueRun> techniques;
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
ShotRun follow(const StabilityOptions& options, const std::string& file, std::optional<GlContext>& context,
               std::optional<double> stillAt = {}) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  // Placing lights is what is measured; the whole pipeline takes minutes for the comparators, which move every map.
  launch.set.insert(launch.set.begin(), "vpl.visibility=rays");
  const auto opened = openLaunch(launch);
  refuseGlossy(opened->settings);
  if (!opened->shot) throw InputError(file, "not a shot (a .json file)");
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
void measureStill(const StabilityOptions& options, const std::string& file, std::optional<GlContext>& context,
                  ShotRun& shot) {
  for (int i = 0; i < options.still; ++i) {
    const ShotRun still = follow(options, file, context, (i + 0.5) / options.still);
    for (size_t t = 0; t < shot.techniques.size(); ++t) {
      shot.techniques[t].marked.still += still.techniques[t].marked.mean.error / options.still;
      shot.techniques[t].grid.still += still.techniques[t].grid.mean.error / options.still;
    }
  }
  shot.still = true;
}

/// Paper 1, table 1: |E'| of smc over that of ir in the sequence that a shot of ours follows.
const std::map<std::string, double> kPublished{
    {"office", 0.57}, {"citadel", 0.61}, {"maze", 0.57}, {"atrium", 0.32}, {"citadel-moving", 0.22}};

/// |E'| of what a technique is compared with: of ir as in paper 1, among techniques from reflective maps of rsm. 0:
/// none.
double simplestChange(const ShotRun& shot, const TechniqueRun& t) {
  const char* name = needsOf(techniqueByName(t.name)).reflective() ? "rsm" : "ir";
  const auto simplest = std::ranges::find(shot.techniques, name, &TechniqueRun::name);
  return simplest != shot.techniques.end() ? simplest->grid.mean.change : 0;
}

/// What is ranked, as rows of figures name it.
struct Statistic {
  const char *key, *title;
  GroupErrors TechniqueRun::*pixels;
  StatisticRuns GroupErrors::*runs;
};
constexpr Statistic kStatistics[] = {{"error_marked", "|E| marked", &TechniqueRun::marked, &GroupErrors::error},
                                     {"change_marked", "|E'| marked", &TechniqueRun::marked, &GroupErrors::change},
                                     {"error_grid", "|E| grid", &TechniqueRun::grid, &GroupErrors::error},
                                     {"change_grid", "|E'| grid", &TechniqueRun::grid, &GroupErrors::change}};

/// Of the shot's techniques. Empty where no pixel is marked: there is nothing to know of them.
std::vector<UncertainValue> estimatesOf(const ShotRun& s, const Statistic& statistic) {
  std::vector<StatisticRuns> all;
  for (const TechniqueRun& t : s.techniques)
    if (s.marked > 0 || statistic.pixels != &TechniqueRun::marked) all.push_back(t.*statistic.pixels.*statistic.runs);
  return estimatesOf(all);
}

Value figuresOf(const ShotRun& s, size_t index) {
  const TechniqueRun& t = s.techniques[index];
  Value row = Value::of("shot", s.name, "technique", t.name, "vpls", t.vpls, "frames", s.truth.size(), "pixels_marked",
                        s.marked, "pixels_grid", s.truth.front().size() - s.marked, "steps", s.steps, "error_marked",
                        t.marked.mean.error, "change_marked", t.marked.mean.change, "error_grid", t.grid.mean.error,
                        "change_grid", t.grid.mean.change, "bias_grid", t.grid.mean.bias, "l90_median",
                        t.latency.median, "l90_worst_tenth", t.latency.worstTenth, "l90_followed", t.latency.followed,
                        "l90_count", t.latency.count, "place_ms", t.placeMs, "truth_error", s.truthError);
  for (const Statistic& statistic : kStatistics)
    if (const auto estimates = estimatesOf(s, statistic); !estimates.empty() && !std::isnan(estimates[index].error))
      row[std::string(statistic.key) + "_se"] = estimates[index].error;
  if (t.latency.count > 0) row["l90"] = std::vector{t.latency.median, t.latency.worstTenth, 100 * t.latency.followed};
  if (const double simplest = simplestChange(s, t); simplest > 0)
    row["change_over_simplest"] = t.grid.mean.change / simplest;
  const auto published = kPublished.find(s.name.substr(0, s.name.find("-small")));
  if (t.name == techniqueTable().front().name && published != kPublished.end()) row["paper_1"] = published->second;
  if (!s.still) return row;
  row["error_still_marked"] = t.marked.still;
  row["error_still_grid"] = t.grid.still;
  row["error_over_still"] = std::vector{t.marked.mean.error / t.marked.still, t.grid.mean.error / t.grid.still};
  return row;
}

const std::vector<TableColumn> kColumns{{"shot", "shot"},
                                        {"technique", "technique"},
                                        {"vpls", "N", "%g", 1, "cut"},
                                        {"error_marked", "\\|E\\| marked", "%.4f"},
                                        {"change_marked", "\\|E'\\| marked", "%.4f"},
                                        {"error_grid", "\\|E\\| grid", "%.4f"},
                                        {"change_grid", "\\|E'\\| grid", "%.4f"},
                                        {"bias_grid", "bias", "%+.4f"},
                                        {"change_over_simplest", "\\|E'\\| over ir's, rsm's", "%.2f"},
                                        {"paper_1", "paper 1", "%.2f"},
                                        {"error_over_still", "\\|E\\| over still", "%.2f"},
                                        {"l90", "L90, worst tenth, % followed", "%.0f"},
                                        {"place_ms", "ms to place", "%.1f"}};

std::string seriesCsv(const ShotRun& s) {
  std::ostringstream out;
  out << "frame,pixel,marked,truth";
  for (const TechniqueRun& t : s.techniques) out << ',' << t.name;
  out << '\n';
  for (size_t f = 0; f < s.truth.size(); ++f)
    for (size_t p = 0; p < s.truth[f].size(); ++p) {
      out << f << ',' << p << ',' << (p < s.marked) << ',' << s.truth[f][p];
      for (const TechniqueRun& t : s.techniques) out << ',' << t.series[f][p];
      out << '\n';
    }
  return out.str();
}

/// Tone-mapped luminance of each marked pixel over time, as paper 1, fig. 7.
std::vector<Plot> plotsOf(const ShotRun& s) {
  std::vector<Plot> plots;
  std::vector<double> seconds;
  for (size_t f = 0; f < s.truth.size(); ++f) seconds.push_back(double(f) / s.fps);
  for (size_t p = 0; p < s.marked; ++p) {
    Plot& plot = plots.emplace_back(format("%s, pixel %zu", s.name.c_str(), p), "time, s",
                                    "luminance, tone-mapped (0 to 1)", false);
    const auto add = [&](const std::string& name, const PixelSeries& series, const char* colour) {
      PlotLine& line = plot.lines.emplace_back(name, seconds, std::vector<double>{}, colour);
      for (const auto& frame : series) line.y.push_back(frame[p]);
    };
    for (const TechniqueRun& t : s.techniques) add(t.name, t.series, nullptr);
    add("truth", s.truth, "#000");
  }
  return plots;
}

/// A row for each technique of each shot, for programs and for the tables.
Value stabilityFigures(const std::vector<ShotRun>& shots) {
  Value figures = Value::list();
  for (const ShotRun& s : shots)
    for (size_t t = 0; t < s.techniques.size(); ++t) figures.add(figuresOf(s, t));
  return figures;
}

/// The rows as Markdown.
std::string stabilityTable(const Value& figures) {
  Value rows = figures;
  for (Value& row : rows.items())
    for (const Statistic& statistic : kStatistics)
      if (const std::string error = std::string(statistic.key) + "_se"; row.has(error))
        row[statistic.key] = format("%.4f ± %.4f", row[statistic.key].number(), row[error].number());
  return tableText(kColumns, rows);
}

/// A line for each shot and error: who is better than whom, as far as noise lets one tell. Empty of one technique.
std::string stabilityRankings(const std::vector<ShotRun>& shots) {
  std::string text;
  for (const ShotRun& s : shots)
    for (const Statistic& statistic : kStatistics) {
      const std::vector<UncertainValue> estimates = estimatesOf(s, statistic);
      if (estimates.size() < 2) continue;
      std::vector<Ranked> all;
      for (size_t i = 0; i < estimates.size(); ++i) all.push_back({s.techniques[i].name, estimates[i]});
      text += "- " + s.name + ", " + statistic.title + ": " + rankingText(ranked(std::move(all))) + "\n";
    }
  if (text.empty()) return text;
  return "Rankings, the least first; a difference counts where seeds and the truth's noise make it in less than one of "
         "twenty cases:\n\n" +
         text;
}

/// stability.csv, stability.md (tables, rankings) and of each shot series-SHOT.csv and of its marked pixels a picture
/// and plots, each in one step.
void writeStabilityReport(const OutputOptions& output, const fs::path& folder, const std::vector<ShotRun>& shots,
                          const std::string& conditions) {
  const Value figures = stabilityFigures(shots);
  std::string page = conditions + "\n\n" + stabilityTable(figures);
  if (const std::string rankings = stabilityRankings(shots); !rankings.empty()) page += "\n" + rankings;
  for (const ShotRun& s : shots) {
    writeText(folder / ("series-" + s.name + ".csv"), seriesCsv(s));
    if (s.marked == 0) continue;
    writeShown(folder / ("marked-" + s.name + ".png"), s.image);
    page += "\n![" + s.name + ", first frame, marked pixels](marked-" + s.name + ".png)\n";
    writeText(folder / ("series-" + s.name + ".svg"), svgOf(plotsOf(s), 2));
    page += "\n![" + s.name + ", marked pixels over time](series-" + s.name + ".svg)\n";
  }
  writeReport(output, folder, "stability", "Temporal stability", page, csvText(figures), figures);
}

void stability(const StabilityOptions& options) {
  for (const std::string& name : options.techniques) techniqueByName(name); // or a guess at what was meant
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
  conditions += format(". %d grid pixels, %zu frames of the first shot", options.grid * options.grid,
                       shots.front().truth.size()) +
                (options.seeds > 1 ? format(", means over %d seeds.", options.seeds) : ".");
  writeStabilityReport(options.output, folder, shots, conditions);
}

} // namespace

void declareStability(CLI::App& app) {
  auto options = std::make_shared<StabilityOptions>();
  Command command(app, "stability", "errors of techniques over the frames of shots, against truth");
  command.texts("SHOT", options->shots, "shot files (.json)", true);
  command.launch(options->launch);
  command.output(options->output, "folder for the report (default out/stability)");
  command.list("--techniques", options->techniques, "comma-separated (default smc,ir,mir,tcas)");
  command.choice("--truth", options->truth, {"path", "reflective"},
                 "path: path tracing (default); reflective: every texel of the reflective shadow maps at every pixel, "
                 "which rsm, isr, hisr and the multires techniques approximate");
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
