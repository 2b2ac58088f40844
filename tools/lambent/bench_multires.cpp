// lambent bench --multires SCENE...: paper 3's table 1. Light gathered at patches of the picture against light splatted
// into them, from the same reflective shadow maps, frame by frame in turn.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "gi/measure/scaled_view.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

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
enum { Gathering, Splatting, kHalves };
constexpr const char* kTechniques[kHalves] = {"multires-gather", "multires-splat"};

/// Median milliseconds of a row.
double medianMs(const Measured& m, size_t row) {
  const auto sum = [](const FrameStats& s, size_t i) {
    double ms = 0;
    for (StageId stage : rows()[i].stages) ms += s.ms(stage);
    return ms;
  };
  return m
      .of([&](const FrameStats& s) {
        double others = 0;
        for (size_t i = 1; i < rows().size(); ++i) others += sum(s, i);
        return row == 0 ? s.wallMs - others : sum(s, row);
      })
      .median;
}

/// All figures of one scene: a column of the table.
nlohmann::json columnOf(const BenchOptions& options, const std::string& file) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  const auto stage = openLaunch(launch);
  needPunctualLight(*stage);
  say(*stage, options.output.quiet);
  std::vector<Variant> variants;
  for (const char* technique : kTechniques) {
    variants.push_back({technique, stage->settings, stage->seed});
    applyTechnique(variants.back().settings, technique);
  }
  Progress progress(fs::path(file).stem().string(), options.output.quiet);
  RunPlan plan = benchPlan(options, *stage, progress);
  std::vector<LightView> lights;
  plan.view = [&, steady = plan.view](int frame) { return unsteady(steady(frame), frame, lights); };
  plan.picture = Buffer::Indirect;
  const std::vector<Measured> halves = measure(variants, plan);

  nlohmann::json j{{"scene", file},
                   {"size", {stage->camera.width, stage->camera.height}},
                   {"frames", halves[0].frames.size()},
                   {"vpls", halves[Gathering].frames.back().vplsAlive},
                   {"patches", halves[Gathering].frames.back().patches}, // that gathered, in the last frame
                   {"rmse_share", pictureError(halves[Splatting].picture, halves[Gathering].picture).rmseShare()}};
  for (const Measured& half : halves) {
    nlohmann::json& ms = j["median_ms"][half.variant.name];
    for (size_t i = 0; i < rows().size(); ++i) ms[rows()[i].key] = medianMs(half, i);
    ms["total"] = half.of([](const FrameStats& s) { return s.wallMs; }).median;
  }
  for (const char* row : {"light", "total"}) {
    const auto ms = [&](int half) { return j["median_ms"][kTechniques[half]][row].get<double>(); };
    j["splat_over_gather"][row] = ms(Gathering) > 0 ? ms(Splatting) / ms(Gathering) : 0;
  }
  return j;
}

/// One line: of each column what stands at the path, as "/median_ms/multires-gather/light".
void print(const nlohmann::json& columns, const char* title, const std::string& path, const char* pattern,
           double factor = 1) {
  std::printf("  %-32s", title);
  for (const nlohmann::json& c : columns) {
    const size_t width = std::max<size_t>(10, fs::path(c["scene"].get<std::string>()).stem().string().size());
    const nlohmann::json& cell = c[nlohmann::json::json_pointer(path)];
    std::printf(" %*s", int(width),
                cell.is_string() ? fs::path(cell.get<std::string>()).stem().c_str()
                                 : format(pattern, factor * cell.get<double>()).c_str());
  }
  std::printf("\n");
}

} // namespace

void benchMultires(const BenchOptions& options) {
  if (!options.launch.technique.empty())
    throw InputError("--technique " + options.launch.technique,
                     "cannot be chosen with --multires, which measures multires-gather and multires-splat");
  for (const std::string& file : options.scenes) // before minutes are spent on those before it
    if (!fs::exists(file)) throw InputError(file, "no such file");
  GlContext context = GlContext::headless();
  nlohmann::json columns;
  for (const std::string& file : options.scenes) columns.push_back(columnOf(options, file));
  writeJson(options.output.json, {{"scenes", columns}});
  if (options.output.quiet) return;
  std::printf(
      "%d x %d, medians in ms; lights waver by a ten-thousandth of the scene, so every stage runs in every frame\n",
      columns[0]["size"][0].get<int>(), columns[0]["size"][1].get<int>());
  for (int k = 0; k < kHalves; ++k) {
    const std::string ms = std::string("/median_ms/") + kTechniques[k] + "/";
    print(columns, kTechniques[k], "/scene", "");
    for (const Row& row : rows()) print(columns, k == Gathering ? row.gathering : row.splatting, ms + row.key, "%.2f");
    print(columns, "Total", ms + "total", "%.2f");
    std::printf("\n");
  }
  print(columns, "splat over gather, light", "/splat_over_gather/light", "%.2f");
  print(columns, "splat over gather, total", "/splat_over_gather/total", "%.2f");
  print(columns, "VPLs", "/vpls", "%.0f");
  print(columns, "Patches", "/patches", "%.0f");
  print(columns, "RMSE of the two, % of mean", "/rmse_share", "%.3f", 100);
  print(columns, "frames", "/frames", "%.0f");
}

} // namespace lambent
