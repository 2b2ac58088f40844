// lambent bench SHOT|SCENE: where the time of a frame goes, and what was done in it; with --against of two settings,
// with --techniques of several techniques, frame by frame in turn. The other forms: bench_*.cpp.
#include "tools/lambent/bench.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cstdio>
#include <string_view>

namespace lambent {

namespace fs = std::filesystem;

namespace {

double countOf(const Figure& figure) {
  if (const uint64_t* n = std::get_if<uint64_t>(&figure)) return double(*n);
  if (const RayCounts* rays = std::get_if<RayCounts>(&figure)) return double(rays->closest + rays->occlusion);
  return -1; // a time, a text
}

/// Whatever the table of figures counts.
std::vector<Line> countLines() {
  std::vector<Line> lines;
  for (const FigureRow& row : figureTable())
    if (row.name != std::string_view("frame") && countOf(row.value({})) >= 0) // a number, no count
      lines.push_back({row.name, [&row](const Measured& m) {
                         return m.of([&row](const FrameStats& s) { return countOf(row.value(s)); });
                       }});
  return lines;
}

/// Shares of all light paths and maps, which tell what is saved from frame to frame.
struct Share {
  const char *key, *title;
  double (*of)(const FrameStats&, const Settings&);
};
double share(double part, double all) { return all > 0 ? part / all : 0; }
constexpr Share kShares[] = {
    {"retraced_paths_share", "light paths traced before and traced again",
     [](const FrameStats& s, const Settings&) { return share(double(s.pathsRetraced), double(s.pathsHeld)); }},
    {"traced_paths_share", "light paths traced, of new VPLs and candidates too",
     [](const FrameStats& s, const Settings&) { return share(double(s.pathsTraced), double(s.pathsHeld)); }},
    {"drawn_maps_share", "VPL shadow maps drawn, in part or whole",
     [](const FrameStats& s, const Settings& set) { return share(s.mapsDrawn, set.smc.vpls); }},
    {"drawn_texels_share", "texels of VPL shadow maps drawn",
     [](const FrameStats& s, const Settings& set) {
       return share(double(s.mapTexelsDrawn), double(set.smc.vpls) * set.shadow.resolution * set.shadow.resolution);
     }},
};
Spread spreadOf(const Share& share, const Measured& m) {
  return m.of([&](const FrameStats& s) { return share.of(s, m.variant.settings); });
}
double mostWaiting(const Measured& m) {
  return m.of([](const FrameStats& s) { return s.mapsWaiting; }).most;
}

Value figuresOf(const Measured& m, const std::vector<Line>& times, const std::vector<Line>& counts) {
  Value figures = Value::of("settings", m.variant.name);
  for (const Line& line : times)
    if (const Spread s = line.of(m); s.count > 0) addSpread(figures, line.name, s);
  const auto of = [](const Spread& s) { return Value::of("median", s.median, "most", s.most); };
  for (const Line& line : counts) figures["counts"][line.name] = of(line.of(m));
  for (const Share& share : kShares) figures[share.key] = of(spreadOf(share, m));
  figures["most_maps_waiting"] = uint64_t(mostWaiting(m));
  return figures;
}

/// Wide enough for times and for the side's name.
int widthOf(const Measured& m) { return std::max(10, int(m.variant.name.size())); }

void print(const std::vector<Line>& lines, const std::vector<Measured>& sides, int digits, bool ratio) {
  for (const Line& line : lines) {
    std::printf("  %-22s", line.name.c_str());
    std::vector<Spread> spreads;
    for (const Measured& m : sides) {
      const Spread s = spreads.emplace_back(line.of(m));
      std::printf(" %*s", widthOf(m), s.count > 0 ? format("%.*f", digits, s.median).c_str() : "");
    }
    if (ratio && spreads[0].count > 0 && spreads[1].median > 0)
      std::printf(" %8.2f", spreads[0].median / spreads[1].median);
    std::printf("\n");
  }
}

std::vector<Variant> sidesOf(const BenchOptions& options, const LaunchContext& opened) {
  std::vector<Variant> sides;
  for (const std::string& technique : options.techniques) {
    LaunchOptions launch = options.launch;
    launch.technique = technique; // under what --set says, which may contradict it
    sides.push_back({technique, chosenSettings(launch, opened.shot), opened.seed});
    // Nothing moves in a scene, and what may keep its picture would cost nothing.
    if (!opened.shot) sides.back().settings.effects[EffectId::Redraw] = EffectMode::On;
  }
  if (!sides.empty()) return sides;
  sides.push_back(variantOf(opened, "as set"));
  if (options.against.empty()) return sides;
  Variant other = variantOf(opened, "");
  for (const std::string& assignment : options.against) {
    const size_t equals = assignment.find('=');
    if (equals == std::string::npos) throw InputError("--against " + assignment, "is not NAME=VALUE");
    applySetting(other.settings, assignment.substr(0, equals), assignment.substr(equals + 1));
    other.name += (other.name.empty() ? "" : " ") + assignment;
  }
  sides.push_back(std::move(other));
  return sides;
}

void benchSides(const BenchOptions& options) {
  if (!options.techniques.empty()) refuseTechnique(options, "goes into --techniques, with the others");
  const auto opened = openLaunch(options.launch, WatchUntil::FirstPicture);
  const std::vector<Variant> variants = sidesOf(options, *opened);
  if (std::ranges::any_of(variants, [](const Variant& v) { return needsOf(v.settings).reflective(); }))
    needPunctualLight(*opened);
  say(*opened, options.output.quiet);
  GlContext context = GlContext::headless();
  const std::vector<Measured> sides = run(variants, benchPlan(options, *opened), "measuring", options.output.quiet);
  const std::vector<Line> times = timeLines(sides), counts = countLines();
  Value figures = Value::of("scene", options.launch.scene, "frames", sides[0].frames.size());
  for (const Measured& m : sides) figures["sides"].add(figuresOf(m, times, counts));
  writeJson(options.output.json, figures);

  if (options.output.quiet) return;
  const bool two = !options.against.empty();
  std::printf("%zu frames of %d x %d, medians in ms\n  %-22s", sides[0].frames.size(), opened->camera.width,
              opened->camera.height, "");
  for (const Measured& m : sides) std::printf(" %*s", widthOf(m), m.variant.name.c_str());
  std::printf(two ? " %8s\n" : "\n", "ratio");
  print(times, sides, 3, two);
  std::printf("counts of a frame, medians\n");
  print(counts, sides, 0, false);
  for (const Measured& m : sides) {
    if (!options.techniques.empty()) break; // not all of them have paths and maps
    std::printf("per frame, %s\n", m.variant.name.c_str());
    for (const Share& share : kShares) {
      const Spread s = spreadOf(share, m);
      std::printf("  %-50s %6.2f %% of all (most %.2f %%)\n", share.title, 100 * s.median, 100 * s.most);
    }
    std::printf("  %-50s %.0f at most\n", "shadow maps that had to wait", mostWaiting(m));
  }
}

void bench(BenchOptions& o) {
  if (o.quick && o.launch.size.empty()) o.launch.size = "64x36";
  if (o.quick && o.frames == 0) o.frames = o.skip + 3;
  if (o.quick && o.form == benchEqualError) useFewLights(o);
  if (o.quick && (o.form == benchArea || o.form == benchCube)) o.samples = o.samples.value_or(16);
  const bool several = o.form && o.form != benchGrowth && o.form != benchRays;
  if (o.scenes.size() > 1 && !several)
    throw InputError(
        o.scenes[1],
        "one scene or shot is enough (several go with --multires, --table2, --equal-error, --area and --cube)");
  for (const std::string& file : o.scenes) // before minutes are spent on those before it
    if (several && !fs::exists(file)) throw InputError(file, "no such file");
  o.launch.scene = o.scenes[0];
  (o.form ? o.form : benchSides)(o);
}

} // namespace

std::vector<Line> timeLines(const std::vector<Measured>& sides) {
  std::vector<Line> lines;
  bool listed[kStages] = {};
  for (const Measured& side : sides)
    for (StageId stage : side.stages())
      if (!std::exchange(listed[size_t(stage)], true))
        lines.push_back({kStageNames[size_t(stage)], [stage](const Measured& m) { return m.ms(stage); }});
  const auto line = [&](const char* name, double FrameStats::*ms) {
    lines.push_back({name, [ms](const Measured& m) { return m.of([ms](const FrameStats& s) { return s.*ms; }); }});
  };
  line("updateVpls", &FrameStats::updateMs);
  line("frame", &FrameStats::wallMs);
  return lines;
}

void addSpread(Value& row, const std::string& key, const Spread& spread) {
  row["median_ms"][key] = spread.median;
  row["quartiles_ms"][key] = std::vector{spread.quarter, spread.threeQuarters};
}

std::string spreadText(double median, const Value& quartiles) {
  const int digits = median < 10 ? 2 : median < 100 ? 1 : 0;
  return format("%.*f (%.*f to %.*f)", digits, median, digits, quartiles.items()[0].number(), digits,
                quartiles.items()[1].number());
}

RunPlan benchPlan(const BenchOptions& options, LaunchContext& opened, int frames) {
  RunPlan plan = planOf(opened, options.frames > 0 || opened.shot ? options.frames : frames);
  plan.skip = options.skip;
  if (plan.frames <= plan.skip)
    throw InputError(options.launch.scene, "of its " + std::to_string(plan.frames) + " frames --skip " +
                                               std::to_string(plan.skip) + " leaves none (--skip 0)");
  return plan;
}

void refuseTechnique(const BenchOptions& options, const std::string& why) {
  if (!options.launch.technique.empty()) throw InputError("--technique " + options.launch.technique, why);
}

void declareBench(CLI::App& app) {
  auto o = std::make_shared<BenchOptions>();
  Command command(app, "bench", "time per stage and work per frame, of one way or of several in turn");
  command.reads("SCENE", o->scenes,
                "glTF or shot file; several with --multires, --table2, --equal-error, --area and --cube", true);
  command.launch(o->launch);
  command.output(o->output, "--table2, --growth, --equal-error: folder for tables and plots (default out/bench)");
  command.number("--frames", &o->frames, 1, 1000000,
                 "only the first so many (60 of a scene; --growth 32; not with --equal-error)");
  command.number("--skip", &o->skip, 1, 1000000, "frames at the start that do not count (default 2)");
  const auto form = [&](const char* name, void (*form)(const BenchOptions&), const char* help) {
    command.flag(
        name, [o, form] { o->form = form; }, help);
  };
  command.beginForms();
  command.texts("--against", o->against, "NAME=VALUE: measure this setting too, frame by frame in turn");
  command.list("--techniques", o->techniques, "comma-separated: measure each");
  form("--multires", benchMultires,
       "light gathered at patches of the picture against light splatted into them, frame by frame in turn "
       "(paper 3, table 1)");
  form("--table2", benchTable2,
       "shots: milliseconds of the steps of paper 1's table 2, medians and quartiles, the paper's beside");
  form("--growth", benchGrowth,
       "how each stage's time grows with virtual lights, pixels, lights, instances and triangles, one at a "
       "time, values in turn: medians, exponents with standard errors, plots");
  form("--equal-error", benchEqualError,
       "the presets' error of indirect irradiance, still and in shots moving, and how long path tracing "
       "takes to the same");
  form("--area", benchArea,
       "direct light of lamps, and of lamps a quarter as wide, at patches that split by their quarters, by "
       "their neighbours, and at every pixel: fragments, time, error (paper 4, table 1)");
  form("--cube", benchCube,
       "layered depth cubes of several resolutions and numbers of lights: time to build and to look up, "
       "memory, error (paper 5, table 1)");
  form("--rays", benchRays, "a million rays on the GPU and with Embree: where they differ, and how many a second");
  command.endForms();
  command.list("--along", o->along, "--growth: comma-separated, only these",
               {"vpls", "pixels", "lights", "instances", "triangles"});
  command.number("--seeds", &o->seeds, 1, 1000, "--equal-error: so many (default 3)");
  command.number("--spp", &o->samples, 2, 1 << 24,
                 "--equal-error, --cube: paths, --area: rays to the lamps per pixel of the truth (2048; 256; 1024)");
  command.number("--frame", &o->frame, 1, 1000000, "--equal-error: of a shot in motion (default 30, or the last)");
  command.flag("--quick", o->quick, "a few small frames, to try whether it runs");
  command.run([o] { bench(*o); });
}

} // namespace lambent
