// lambent bench --multires SCENE...: paper 3's table 1. Light gathered at patches of the picture against light splatted
// into them, from the same reflective shadow maps, frame by frame in turn.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace lambent {

namespace {

/// A row of the table: what the paper calls it in either half, and the stages of ours that it sums.
struct Row {
  const char *gathering, *splatting, *key;
  std::vector<std::string> stages;
};
/// The first row has what no other names: as the paper's, it "includes all other rendering overhead".
const std::vector<Row>& rows() {
  static const std::vector<Row> table{
      {"Direct light", "Direct light", "direct", {}},
      {"Generate reflective shadow map",
       "Generate reflective shadow map",
       "reflective_maps",
       {"reflective maps", "reflective lights"}},
      {"Create min-max mipmap", "Create min-max mipmap", "mipmap", {"patches"}},
      {"Multires stencil setup", "Geometry shader refinement", "refinement", {"stencil", "refine"}},
      {"Multires light gather", "Multires light splatting", "light", {"gather", "splat"}},
      {"Upsample indirect illumination", "Upsample indirect illumination", "upsample", {"upsample"}},
  };
  return table;
}
constexpr size_t kLight = 4;

enum { Gathering, Splatting, kHalves };
constexpr const char* kTechniques[kHalves] = {"multires-gather", "multires-splat"};

/// Milliseconds of one technique in one scene, frame by frame.
struct Times {
  std::array<std::vector<double>, 6> rows;
  std::vector<double> total;

  void add(const FrameStats& stats) {
    double others = 0;
    for (size_t i = 1; i < rows.size(); ++i) {
      double ms = 0;
      for (const StageTime& t : stats.stages)
        if (std::ranges::count(lambent::rows()[i].stages, t.stage.name)) ms += std::max(t.cpuMs, t.gpuMs);
      rows[i].push_back(ms);
      others += ms;
    }
    rows[0].push_back(stats.wallMs - others);
    total.push_back(stats.wallMs);
  }
};

struct Column {
  std::string file, name;
  glm::ivec2 size{0}; // pixels
  int frames = 0;
  Times times[kHalves];
  uint32_t vpls[kHalves] = {};
  uint64_t patches = 0; // that gathered, in the last frame
  double rmseShare = 0; // between the last frames' indirect radiance, share of its mean

  double lightRatio() const { return ratio(times[Splatting].rows[kLight], times[Gathering].rows[kLight]); }
  double totalRatio() const { return ratio(times[Splatting].total, times[Gathering].total); }

 private:
  static double ratio(const std::vector<double>& a, const std::vector<double>& b) {
    return median(b) > 0 ? median(a) / median(b) : 0;
  }
};

/// The view with every punctual light a ten-thousandth of the scene aside in every other frame, so that no map is kept
/// and every stage runs in every frame.
SceneView unsteady(SceneView view, int frame, std::vector<LightView>& lights) {
  constexpr float kShare = 1e-4f;
  lights.assign(view.lights.begin(), view.lights.end());
  for (LightView& light : lights) {
    const vec3 aside = frame % 2 == 0 ? vec3(0) : vec3(kShare, 0, kShare);
    light.position += view.boundsWorld.diameter() * aside;
    if (light.type == LightType::Directional) light.direction = glm::normalize(light.direction + aside);
    light.changed = true;
  }
  view.lights = lights;
  view.changes.lights = true;
  return view;
}

Column measure(const BenchOptions& options, const std::string& file) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  const auto stage = openStage(launch);
  needPunctualLight(*stage);
  say(*stage, options.output.quiet);
  std::unique_ptr<GiFrame> gi[kHalves];
  for (int k = 0; k < kHalves; ++k) {
    Settings settings = stage->settings;
    applyTechnique(settings, kTechniques[k]);
    // Timer queries that lag would give one technique's times to the other.
    if (settings.debug.timing == TimingMode::Auto) settings.debug.timing = TimingMode::Finish;
    gi[k] = std::make_unique<GiFrame>(settings, stage->seed);
  }
  const int total = framesOf(options, *stage);
  const double fps = stage->shot ? stage->shot->fps : 30;
  Column column;
  column.file = file;
  column.name = std::filesystem::path(file).stem().string();
  column.size = {stage->camera.width, stage->camera.height};
  column.frames = total - options.skip;
  Progress progress(column.name, options.output.quiet);
  std::vector<LightView> lights;
  for (int frame = 0; frame < total; ++frame) {
    if (interrupted) throw RunError("interrupted: nothing is written");
    const SceneView view = unsteady(stage->at(frame / fps), frame, lights);
    for (int turn = 0; turn < kHalves; ++turn) { // A B, B A
      const int k = (turn + frame) % kHalves;
      const FrameStats& stats = gi[k]->run(view);
      column.vpls[k] = stats.vplsAlive;
      if (k == Gathering) column.patches = stats.patches;
      if (frame >= options.skip) column.times[k].add(stats);
    }
    progress.update(frame + 1, total);
  }
  column.rmseShare = rmseShare(gi[Splatting]->read(Buffer::Indirect), gi[Gathering]->read(Buffer::Indirect));
  return column;
}

nlohmann::json figuresOf(const Column& c) {
  nlohmann::json j{{"scene", c.file},
                   {"size", {c.size.x, c.size.y}},
                   {"frames", c.frames},
                   {"vpls", c.vpls[Gathering]},
                   {"patches", c.patches},
                   {"splat_over_gather", {{"light", c.lightRatio()}, {"total", c.totalRatio()}}},
                   {"rmse_share", c.rmseShare}};
  for (int k = 0; k < kHalves; ++k) {
    nlohmann::json& half = j["median_ms"][kTechniques[k]];
    for (size_t i = 0; i < rows().size(); ++i) half[rows()[i].key] = median(c.times[k].rows[i]);
    half["total"] = median(c.times[k].total);
  }
  return j;
}

void print(const std::vector<Column>& columns, const std::string& title,
           const std::function<std::string(const Column&)>& cell) {
  std::printf("  %-32s", title.c_str());
  for (const Column& c : columns) std::printf(" %*s", int(std::max<size_t>(10, c.name.size())), cell(c).c_str());
  std::printf("\n");
}

} // namespace

void benchMultires(const BenchOptions& options) {
  if (!options.launch.technique.empty())
    throw InputError("--technique " + options.launch.technique,
                     "cannot be chosen with --multires, which measures multires-gather and multires-splat");
  for (const std::string& file : options.scenes) // before minutes are spent on those before it
    if (!std::filesystem::exists(file)) throw InputError(file, "no such file");
  GlContext context = GlContext::headless();
  std::vector<Column> columns;
  for (const std::string& file : options.scenes) columns.push_back(measure(options, file));

  nlohmann::json j;
  for (const Column& c : columns) j["scenes"].push_back(figuresOf(c));
  writeJson(options.output.json, j);
  if (options.output.quiet) return;
  std::printf(
      "%d x %d, medians in ms; lights waver by a ten-thousandth of the scene, so every stage runs in every frame\n",
      columns[0].size.x, columns[0].size.y);
  for (int k = 0; k < kHalves; ++k) {
    print(columns, kTechniques[k], [](const Column& c) { return c.name; });
    for (size_t i = 0; i < rows().size(); ++i)
      print(columns, k == Gathering ? rows()[i].gathering : rows()[i].splatting,
            [&](const Column& c) { return format("%.2f", median(c.times[k].rows[i])); });
    print(columns, "Total", [&](const Column& c) { return format("%.2f", median(c.times[k].total)); });
    std::printf("\n");
  }
  print(columns, "splat over gather, light", [](const Column& c) { return format("%.2f", c.lightRatio()); });
  print(columns, "splat over gather, total", [](const Column& c) { return format("%.2f", c.totalRatio()); });
  print(columns, "VPLs", [](const Column& c) { return format("%u", c.vpls[Gathering]); });
  print(columns, "Patches", [](const Column& c) { return format("%llu", (unsigned long long)c.patches); });
  print(columns, "RMSE of the two, % of mean", [](const Column& c) { return format("%.3f", 100 * c.rmseShare); });
  print(columns, "frames", [](const Column& c) { return format("%d", c.frames); });
}

} // namespace lambent
