// lambent bench --multires SCENE...: paper 3's table 1. Light gathered at patches of the picture against light splatted
// into them, from the same reflective shadow maps, frame by frame in turn.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace {

/// A row of the table: what the paper calls it in either half, and the stages of ours that it sums.
struct Row {
  const char *gathering, *splatting, *key;
  std::vector<StageId> stages;
};
/// The first row has what no other names: as the paper's, it "includes all other rendering overhead".
const std::vector<Row>& rows() {
  using enum StageId;
  static const std::vector<Row> table{
      {"Direct light", "Direct light", "direct", {}},
      {"Generate reflective shadow map",
       "Generate reflective shadow map",
       "reflective_maps",
       {ReflectiveMaps, ReflectiveLights}},
      {"Create min-max mipmap", "Create min-max mipmap", "mipmap", {Patches}},
      {"Multires stencil setup", "Geometry shader refinement", "refinement", {Stencil, Refine}},
      {"Multires light gather", "Multires light splatting", "light", {Gather, Splat}},
      {"Upsample indirect illumination", "Upsample indirect illumination", "upsample", {Upsample}},
  };
  return table;
}
constexpr size_t kLight = 4;

enum { Gathering, Splatting, kHalves };
constexpr const char* kTechniques[kHalves] = {"multires-gather", "multires-splat"};

struct Column {
  std::string file, name;
  glm::ivec2 size{0}; // pixels
  std::vector<Measured> halves;
  double rmseShare = 0; // between the last frames' indirect radiance, share of its mean

  const FrameStats& last() const { return halves[Gathering].frames.back(); }
  /// Median milliseconds of a row.
  double ms(int half, size_t row) const {
    const auto sum = [](const FrameStats& s, size_t i) {
      double ms = 0;
      for (StageId stage : rows()[i].stages) ms += s.ms(stage);
      return ms;
    };
    return halves[half]
        .of([&](const FrameStats& s) {
          double others = 0;
          for (size_t i = 1; i < rows().size(); ++i) others += sum(s, i);
          return row == 0 ? s.wallMs - others : sum(s, row);
        })
        .median;
  }
  double total(int half) const {
    return halves[half].of([](const FrameStats& s) { return s.wallMs; }).median;
  }
  double lightRatio() const { return ratio(ms(Splatting, kLight), ms(Gathering, kLight)); }
  double totalRatio() const { return ratio(total(Splatting), total(Gathering)); }

 private:
  static double ratio(double a, double b) { return b > 0 ? a / b : 0; }
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

Column columnOf(const BenchOptions& options, const std::string& file) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  const auto stage = openStage(launch);
  needPunctualLight(*stage);
  say(*stage, options.output.quiet);
  std::vector<Variant> variants;
  for (const char* technique : kTechniques) {
    variants.push_back({technique, stage->settings, stage->seed});
    applyTechnique(variants.back().settings, technique);
  }
  const std::string name = std::filesystem::path(file).stem().string();
  Progress progress(name, options.output.quiet);
  RunPlan plan = benchPlan(options, *stage, progress);
  std::vector<LightView> lights;
  plan.view = [&, steady = plan.view](int frame) { return unsteady(steady(frame), frame, lights); };
  plan.picture = Buffer::Indirect;
  Column column{file, name, {stage->camera.width, stage->camera.height}, measure(variants, plan)};
  column.rmseShare = pictureError(column.halves[Splatting].picture, column.halves[Gathering].picture).rmseShare();
  return column;
}

nlohmann::json figuresOf(const Column& c) {
  nlohmann::json j{{"scene", c.file},
                   {"size", {c.size.x, c.size.y}},
                   {"frames", c.halves[0].frames.size()},
                   {"vpls", c.last().vplsAlive},
                   {"patches", c.last().patches},
                   {"splat_over_gather", {{"light", c.lightRatio()}, {"total", c.totalRatio()}}},
                   {"rmse_share", c.rmseShare}};
  for (int k = 0; k < kHalves; ++k) {
    nlohmann::json& half = j["median_ms"][kTechniques[k]];
    for (size_t i = 0; i < rows().size(); ++i) half[rows()[i].key] = c.ms(k, i);
    half["total"] = c.total(k);
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
  for (const std::string& file : options.scenes) columns.push_back(columnOf(options, file));

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
            [&](const Column& c) { return format("%.2f", c.ms(k, i)); });
    print(columns, "Total", [&](const Column& c) { return format("%.2f", c.total(k)); });
    std::printf("\n");
  }
  print(columns, "splat over gather, light", [](const Column& c) { return format("%.2f", c.lightRatio()); });
  print(columns, "splat over gather, total", [](const Column& c) { return format("%.2f", c.totalRatio()); });
  print(columns, "VPLs", [](const Column& c) { return format("%u", c.last().vplsAlive); });
  print(columns, "Patches", [](const Column& c) { return format("%llu", (unsigned long long)c.last().patches); });
  print(columns, "RMSE of the two, % of mean", [](const Column& c) { return format("%.3f", 100 * c.rmseShare); });
  print(columns, "frames", [](const Column& c) { return format("%zu", c.halves[0].frames.size()); });
}

} // namespace lambent
