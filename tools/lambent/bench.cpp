// lambent bench SHOT|SCENE: where the time of a frame goes, and what was done in it; with --against of two settings,
// with --techniques of several techniques, frame by frame in turn. Other forms: bench_multires.cpp, bench_tables.cpp
// (--table2), bench_growth.cpp, bench_equal_error.cpp, bench_rays.cpp.
#include "tools/lambent/bench.h"

#include "engine/core/error.h"
#include "engine/platform/gl_context.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cstdio>
#include <string_view>

namespace lambent {

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

nlohmann::json figuresOf(const Measured& m, const std::vector<Line>& times, const std::vector<Line>& counts) {
  nlohmann::json j{{"settings", m.variant.name}};
  for (const Line& line : times) {
    const Spread s = line.of(m);
    if (s.count == 0) continue;
    j["median_ms"][line.name] = s.median;
    j["quartiles_ms"][line.name] = {s.quarter, s.threeQuarters};
  }
  const auto of = [](const Spread& s) { return nlohmann::json{{"median", s.median}, {"most", s.most}}; };
  for (const Line& line : counts) j["counts"][line.name] = of(line.of(m));
  for (const Share& share : kShares) j[share.key] = of(spreadOf(share, m));
  j["most_maps_waiting"] = uint64_t(mostWaiting(m));
  return j;
}

/// Wide enough for times and for the side's name.
int widthOf(const Measured& m) { return std::max(10, int(m.variant.name.size())); }

void print(const std::vector<Line>& lines, const std::vector<Measured>& sides, int digits, bool ratio) {
  for (const Line& line : lines) {
    std::printf("  %-22s", line.name.c_str());
    std::vector<Spread> spreads;
    for (const Measured& m : sides) {
      spreads.push_back(line.of(m));
      if (spreads.back().count > 0)
        std::printf(" %*.*f", widthOf(m), digits, spreads.back().median);
      else
        std::printf(" %*s", widthOf(m), "");
    }
    if (ratio && spreads[0].count > 0 && spreads[1].median > 0)
      std::printf(" %8.2f", spreads[0].median / spreads[1].median);
    std::printf("\n");
  }
}

std::vector<Variant> sidesOf(const BenchOptions& options, const LaunchContext& stage) {
  std::vector<Variant> sides;
  for (const std::string& technique : options.techniques) {
    LaunchOptions launch = options.launch;
    launch.technique = technique; // under what --set says, which may contradict it
    sides.push_back({technique, chosenSettings(launch, stage.shot), stage.seed});
    // Nothing moves in a scene, and what may keep its picture would cost nothing.
    if (!stage.shot) sides.back().settings.effects[EffectId::Redraw] = EffectMode::On;
  }
  if (!sides.empty()) return sides;
  sides.push_back({"as set", stage.settings, stage.seed});
  if (options.against.empty()) return sides;
  Variant other{"", stage.settings, stage.seed};
  for (const std::string& assignment : options.against) {
    const size_t equals = assignment.find('=');
    if (equals == std::string::npos) throw InputError("--against " + assignment, "is not NAME=VALUE");
    applySetting(other.settings, assignment.substr(0, equals), assignment.substr(equals + 1));
    other.name += (other.name.empty() ? "" : " ") + assignment;
  }
  sides.push_back(std::move(other));
  return sides;
}

void bench(const BenchOptions& options) {
  if (options.multires) return benchMultires(options);
  if (options.table2) return benchTable2(options);
  if (options.equalError) return benchEqualError(options);
  if (options.area) return benchArea(options);
  if (options.cube) return benchCube(options);
  if (options.launch.scene.empty())
    throw InputError(
        options.scenes[1],
        "one scene or shot is enough (several go with --multires, --table2, --equal-error, --area and --cube)");
  if (options.growth) return benchGrowth(options);
  if (options.rays) return benchRays(options);
  if (!options.techniques.empty() && !options.launch.technique.empty())
    throw InputError("--technique " + options.launch.technique, "goes into --techniques, with the others");
  const auto stage = openLaunch(options.launch);
  const std::vector<Variant> variants = sidesOf(options, *stage);
  if (std::ranges::any_of(variants, [](const Variant& v) { return needsOf(v.settings).reflective(); }))
    needPunctualLight(*stage);
  say(*stage, options.output.quiet);
  GlContext context = GlContext::headless();
  std::vector<Measured> sides;
  {
    Progress progress("measuring", options.output.quiet);
    sides = measure(variants, benchPlan(options, *stage, progress));
  }
  const std::vector<Line> times = timeLines(sides), counts = countLines();
  nlohmann::json j{{"scene", options.launch.scene}, {"frames", sides[0].frames.size()}};
  for (const Measured& m : sides) j["sides"].push_back(figuresOf(m, times, counts));
  writeJson(options.output.json, j);

  if (options.output.quiet) return;
  const bool two = !options.against.empty();
  std::printf("%zu frames of %d x %d, medians in ms\n  %-22s", sides[0].frames.size(), stage->camera.width,
              stage->camera.height, "");
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

std::string spreadText(const Spread& s) {
  const int digits = s.median < 10 ? 2 : s.median < 100 ? 1 : 0;
  return format("%.*f (%.*f to %.*f)", digits, s.median, digits, s.quarter, digits, s.threeQuarters);
}

RunPlan benchPlan(const BenchOptions& options, LaunchContext& stage, Progress& progress, int frames) {
  RunPlan plan = planOf(stage, progress, options.frames > 0 || stage.shot ? options.frames : frames);
  plan.skip = options.skip;
  if (plan.frames <= plan.skip) throw InputError("--skip", "leaves no frame of " + std::to_string(plan.frames));
  return plan;
}

void declareBench(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command =
      app.add_subcommand("bench", "time per stage and work per frame, of one way or of several in turn");
  command
      ->add_option("SCENE", options->scenes,
                   "glTF or shot file; several with --multires, --table2, --equal-error, --area and --cube")
      ->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output,
                   "--table2, --growth, --equal-error: folder for tables and plots (default out/bench)");
  command
      ->add_option("--frames", options->frames,
                   "only the first so many (60 of a scene; --growth 32; not with --equal-error)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--skip", options->skip, "frames at the start that do not count (default 2)")
      ->check(CLI::Range(1, 1000000));
  CLI::App* forms = command->add_option_group("Forms", "at most one")->require_option(0, 1);
  forms->add_option("--against", options->against, "NAME=VALUE: measure this setting too, frame by frame in turn");
  forms->add_option("--techniques", options->techniques, "comma-separated: measure each")->delimiter(',');
  forms->add_flag("--multires", options->multires,
                  "light gathered at patches of the picture against light splatted into them, frame by frame in turn "
                  "(paper 3, table 1)");
  forms->add_flag("--table2", options->table2,
                  "shots: milliseconds of the steps of paper 1's table 2, medians and quartiles, the paper's beside");
  forms->add_flag("--growth", options->growth,
                  "how each stage's time grows with virtual lights, pixels, lights, instances and triangles, one at a "
                  "time, values in turn: medians, exponents with standard errors, plots");
  forms->add_flag("--equal-error", options->equalError,
                  "the presets' error of indirect irradiance, still and in shots moving, and how long path tracing "
                  "takes to the same");
  forms->add_flag("--area", options->area,
                  "direct light of lamps, and of lamps a quarter as wide, at patches that split by their quarters, by "
                  "their neighbours, and at every pixel: fragments, time, error (paper 4, table 1)");
  forms->add_flag("--cube", options->cube,
                  "layered depth cubes of several resolutions and numbers of lights: time to build and to look up, "
                  "memory, error (paper 5, table 1)");
  forms->add_flag("--rays", options->rays,
                  "a million rays on the GPU and with Embree: where they differ, and how many a second");
  command->add_option("--along", options->along, "--growth: comma-separated, only these")
      ->delimiter(',')
      ->check(CLI::IsMember({"vpls", "pixels", "lights", "instances", "triangles"}));
  command->add_option("--seeds", options->seeds, "--equal-error: so many (default 3)")->check(CLI::Range(1, 1000));
  command
      ->add_option("--spp", options->samples,
                   "--equal-error, --area, --cube: paths per pixel of the truth (2048; 1024)")
      ->check(CLI::Range(2, 1 << 24));
  command->add_option("--frame", options->frame, "--equal-error: of a shot in motion (default 30, or the last)")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--quick", options->quick, "a few small frames, to try whether it runs");
  command->callback([options] {
    if (options->quick && options->launch.size.empty()) options->launch.size = "64x36";
    if (options->quick && options->frames == 0) options->frames = options->skip + 3;
    if (options->scenes.size() == 1) options->launch.scene = options->scenes[0];
    bench(*options);
  });
}

} // namespace lambent
