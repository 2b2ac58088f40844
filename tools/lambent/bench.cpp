// lambent bench SHOT|SCENE: where the time of a frame goes, and what was done in it; with --against, two settings frame
// by frame in turn. With --multires see bench_multires.cpp.
#include "tools/lambent/bench.h"

#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"

#include <algorithm>
#include <cstdio>
#include <map>

namespace lambent {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

namespace {

/// What one of the settings did, frame by frame.
struct Side {
  std::string name;
  std::unique_ptr<GiFrame> gi;
  std::vector<std::string> order; // of rows
  std::map<std::string, std::vector<double>> rows;
  std::vector<double> retraced, traced, maps, texels; // shares of all
  std::vector<double> draws, waits, readBacks;
  uint32_t mostWaiting = 0;

  void note(const std::string& row, double value) {
    if (!rows.contains(row)) order.push_back(row);
    rows[row].push_back(value);
  }

  void add(const FrameStats& s, const Settings& settings) {
    std::map<std::string, double> ms;
    for (const StageTime& t : s.stages) {
      if (!ms.contains(t.stage.name) && !rows.contains(t.stage.name)) order.push_back(t.stage.name);
      ms[t.stage.name] += std::max(t.cpuMs, t.gpuMs);
    }
    for (const auto& [name, value] : ms) rows[name].push_back(value);
    note("updateVpls", s.updateMs);
    note("frame", s.wallMs);
    const auto share = [](double part, double all) { return all > 0 ? part / all : 0; };
    retraced.push_back(share(double(s.pathsRetraced), double(s.pathsHeld)));
    traced.push_back(share(double(s.pathsTraced), double(s.pathsHeld)));
    maps.push_back(share(s.mapsDrawn, settings.smc.vpls));
    const double mapTexels = double(settings.shadow.resolution) * settings.shadow.resolution;
    texels.push_back(share(double(s.mapTexelsDrawn), settings.smc.vpls * mapTexels));
    mostWaiting = std::max(mostWaiting, s.mapsWaiting);
    draws.push_back(double(s.draws));
    waits.push_back(double(s.waits));
    readBacks.push_back(double(s.readBacks));
  }

  nlohmann::json figures() const {
    nlohmann::json j{{"settings", name}};
    for (const std::string& row : order) j["median_ms"][row] = median(rows.at(row));
    const auto of = [](const std::vector<double>& v) {
      return nlohmann::json{{"median", median(v)}, {"most", v.empty() ? 0 : *std::max_element(v.begin(), v.end())}};
    };
    j["retraced_paths_share"] = of(retraced);
    j["traced_paths_share"] = of(traced);
    j["drawn_maps_share"] = of(maps);
    j["drawn_texels_share"] = of(texels);
    j["most_maps_waiting"] = mostWaiting;
    j["draws"] = of(draws);
    j["waits"] = of(waits);
    j["read_backs"] = of(readBacks);
    return j;
  }
};

void printShares(const Side& side) {
  const auto line = [](const char* what, const std::vector<double>& v) {
    std::printf("  %-46s %6.2f %% of all (most %.2f %%)\n", what, 100 * median(v),
                v.empty() ? 0 : 100 * *std::max_element(v.begin(), v.end()));
  };
  std::printf("per frame, %s\n", side.name.c_str());
  line("light paths traced before and traced again", side.retraced);
  line("light paths traced, of new VPLs and candidates too", side.traced);
  line("VPL shadow maps drawn, in part or whole", side.maps);
  line("texels of VPL shadow maps drawn", side.texels);
  std::printf("  %-46s %u at most\n", "shadow maps that had to wait", side.mostWaiting);
  const auto calls = [](const char* what, const std::vector<double>& v) {
    std::printf("  %-46s %.0f (most %.0f)\n", what, median(v), v.empty() ? 0 : *std::max_element(v.begin(), v.end()));
  };
  calls("draw calls", side.draws);
  calls("waits for the GPU", side.waits);
  calls("read-backs from the GPU", side.readBacks);
}

void bench(const BenchOptions& options) {
  if (options.multires) return benchMultires(options);
  if (options.launch.scene.empty())
    throw InputError(options.scenes[1], "one scene or shot is enough (several go with --multires)");
  const auto stage = openStage(options.launch);
  say(*stage, options.output.quiet);
  GlContext context = GlContext::headless();
  std::vector<Side> sides(options.against.empty() ? 1 : 2);
  Settings settings[2] = {stage->settings, stage->settings};
  sides[0].name = "as set";
  for (const std::string& assignment : options.against) {
    const size_t equals = assignment.find('=');
    if (equals == std::string::npos) throw InputError("--against " + assignment, "is not NAME=VALUE");
    applySetting(settings[1], assignment.substr(0, equals), assignment.substr(equals + 1));
    sides[1].name += (sides[1].name.empty() ? "" : " ") + assignment;
  }
  for (Settings& s : settings) // timer queries that lag would give one side's times to the other
    if (s.debug.timing == TimingMode::Auto) s.debug.timing = TimingMode::Finish;
  for (size_t i = 0; i < sides.size(); ++i) sides[i].gi = std::make_unique<GiFrame>(settings[i], stage->seed);

  const double fps = stage->shot ? stage->shot->fps : 30;
  const int total = framesOf(options, *stage);
  {
    Progress progress("measuring", options.output.quiet);
    for (int frame = 0; frame < total && !interrupted; ++frame) {
      const SceneView view = stage->at(frame / fps);
      // In turn, and the first of one frame is the second of the next, so that neither has the caches to itself.
      for (size_t k = 0; k < sides.size(); ++k) {
        const size_t side = (k + size_t(frame)) % sides.size();
        const FrameStats& stats = sides[side].gi->run(view);
        if (frame >= options.skip) sides[side].add(stats, settings[side]);
      }
      progress.update(frame + 1, total);
    }
  }
  nlohmann::json j{{"scene", options.launch.scene}, {"frames", total - options.skip}};
  for (const Side& s : sides) j["sides"].push_back(s.figures());
  writeJson(options.output.json, j);

  if (options.output.quiet) return;
  std::printf("%d frames of %d x %d, medians in ms\n", total - options.skip, stage->camera.width, stage->camera.height);
  std::printf("  %-22s %10s", "", sides[0].name.c_str());
  if (sides.size() > 1) std::printf(" %10s %8s", "against", "ratio");
  std::printf("\n");
  for (const std::string& row : sides[0].order) {
    const double a = median(sides[0].rows.at(row));
    std::printf("  %-22s %10.3f", row.c_str(), a);
    if (sides.size() > 1 && sides[1].rows.contains(row)) {
      const double b = median(sides[1].rows.at(row));
      std::printf(" %10.3f %8.2f", b, b > 0 ? a / b : 0);
    }
    std::printf("\n");
  }
  for (const Side& s : sides) printShares(s);
}

} // namespace

int framesOf(const BenchOptions& options, const Stage& stage) {
  const int shotFrames = stage.shot ? stage.shot->frameCount() : 60;
  const int total = options.frames > 0 ? std::min(options.frames, shotFrames) : shotFrames;
  if (total <= options.skip) throw InputError("--skip", "leaves no frame of " + std::to_string(total));
  return total;
}

void declareBench(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand("bench", "time per stage and work per frame; with --against, of two settings");
  command->add_option("SCENE", options->scenes, "glTF or shot file; several with --multires")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output, "");
  command->add_option("--frames", options->frames, "only the first so many (60 of a scene)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--skip", options->skip, "frames at the start that do not count (default 2)")
      ->check(CLI::Range(1, 1000000));
  CLI::Option* against = command->add_option("--against", options->against,
                                             "NAME=VALUE: measure this setting too, frame by frame in turn");
  command
      ->add_flag("--multires", options->multires,
                 "light gathered at patches of the picture against light splatted into them, frame by frame in turn "
                 "(paper 3, table 1)")
      ->excludes(against);
  command->callback([options] {
    if (options->scenes.size() == 1) options->launch.scene = options->scenes[0];
    bench(*options);
  });
}

} // namespace lambent
