// lambent bench --cube SCENE...: the layered depth cube beside the technique of the settings (paper 5, table 1):
// building and looking up for cubes of several resolutions, with few lights and many, by rays and by hemicubes; frames
// of a camera that moves, in turn; error against path tracing.
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "gi/measure/statistics.h"
#include "gi/reference/traced_picture.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/text.h"

#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

struct CubeVariant {
  std::string name;
  Settings settings;
};

std::vector<CubeVariant> variantsOf(const LaunchContext& stage, bool quick) {
  std::vector<CubeVariant> all;
  Settings other = stage.settings;
  other.effects[EffectId::Redraw] = EffectMode::On;
  all.push_back({techniqueOf(other).name, other});
  Settings cube = other;
  applyTechnique(cube, "ibrr");
  const auto add = [&](int resolution, int levels, int lights, CubeSights sights) {
    Settings s = cube;
    s.cube.resolution = resolution;
    s.cube.levels = levels;
    s.cube.sights = sights;
    s.smc.vpls = lights;
    const std::string tree = levels > 0 ? " in " + std::to_string(levels) + " levels" : "";
    all.push_back({"ibrr " + std::to_string(resolution) + tree + ", " + std::to_string(lights) + " lights, " +
                       (sights == CubeSights::Rays ? "rays" : "hemicubes"),
                   s});
  };
  using enum CubeSights;
  const int standard = cube.cube.resolution;
  if (quick) {
    add(16, 0, 64, Rays);
    add(16, 2, 64, Rays);
    return all;
  }
  for (const int resolution : {standard, standard * 2, standard * 4}) add(resolution, 0, 200, Rays);
  add(standard / 4, 4, 200, Rays);
  add(standard, 0, 750, Rays);
  add(standard, 0, 2048, Rays);
  add(standard, 0, 200, Hemicubes);
  add(standard, 0, 750, Hemicubes);
  return all;
}

/// Milliseconds of a frame that go to indirect light.
double indirectMs(const FrameStats& stats) {
  using enum StageId;
  double ms = 0;
  for (size_t s = 0; s < kStages; ++s) {
    const StageId id = StageId(s);
    const bool others = id == Scene || id == Surfaces || id == LightMaps || id == Emitters || id == EmitterMaps ||
                        id == Direct || id == ShadowRays || id == AreaRays || id == AreaLight || id >= Composite;
    if (!others) ms += stats.ms(id);
  }
  return ms;
}

void addRows(const BenchOptions& options, const std::string& file, nlohmann::json& rows) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  if (launch.size.empty()) launch.size = options.quick ? "64x36" : "640x360";
  const auto stage = openLaunch(launch);
  GlContext context = GlContext::headless();
  Progress progress("measuring", options.output.quiet);
  const SceneView still = stage->at(0);
  const TracedPicture truth = tracePicture(still, stage->settings,
                                           {.buffer = ReferenceBuffer::Irradiance,
                                            .samples = uint32_t(options.samples.value_or(options.quick ? 16 : 256)),
                                            .seed = stage->seed,
                                            .cancelled = [] { return bool(interrupted); }});
  const double noise = expectedRelMse(truth.picture.mean, truth.picture.error);
  size_t triangles = 0;
  for (const InstanceView& i : still.instances) triangles += still.assets->meshes[i.mesh].triangles.size();
  const std::vector<CubeVariant> variants = variantsOf(*stage, options.quick);
  const int frames = options.quick ? 2 : 16, settle = options.quick ? 1 : 64;
  std::unique_ptr<Viewer> beside; // of the settings' technique, frame by frame in turn with each cube
  for (const CubeVariant& variant : variants) {
    const bool own = &variant == &variants.front();
    auto gi = std::make_unique<Viewer>(variant.settings, stage->seed);
    SceneView view = still;
    const FrameStats first = gi->run(view);
    view.changes = {false, false, false, false, false};
    // Light that is averaged over pictures has its time; a cube's is there.
    for (int f = 1; own && f < settle; ++f) gi->run(view);
    const PictureError error = pictureError(gi->read(Buffer::Irradiance), truth.picture.mean);
    if (own) beside = std::move(gi);
    std::vector<double> cubeMs, otherMs, wallMs;
    const float step = 0.002f * view.boundsWorld.diameter();
    for (int f = 0; f < frames; ++f) {
      view.changes.camera = true;
      view.camera.worldFromView[3] += view.camera.worldFromView[0] * (f % 8 < 4 ? step : -step);
      otherMs.push_back(indirectMs(beside->run(view)));
      const FrameStats& stats = own ? beside->run(view) : gi->run(view);
      cubeMs.push_back(indirectMs(stats));
      wallMs.push_back(stats.wallMs);
      if (interrupted) throw RunError("interrupted");
    }
    nlohmann::json row{{"scene", fs::path(file).stem().string()},
                       {"triangles", triangles},
                       {"variant", variant.name},
                       {"indirect_ms", spreadOf(cubeMs).median},
                       {"frame_ms", spreadOf(wallMs).median},
                       {"rmse_share", error.rmseShare()},
                       {"rel_mse", std::max(error.relMse - noise, 0.0)}};
    if (!own) {
      row["build_s"] = (first.ms(StageId::Cube) + first.ms(StageId::NearLight)) / 1000;
      row["share"] = spreadOf(cubeMs).median / spreadOf(otherMs).median;
      row["entries"] = first.cubeEntries;
      row["cubes"] = first.cubes;
      row["looked_up_mib"] = double(first.cubeBytes) / (1 << 20);
      row["kept_mib"] = double(first.cubeKeptBytes) / (1 << 20);
    }
    rows.push_back(row);
    progress.update(int(&variant - variants.data()) + 1, int(variants.size()));
  }
}

} // namespace

void benchCube(const BenchOptions& options) {
  nlohmann::json rows;
  for (const std::string& file : options.scenes) addRows(options, file, rows);
  writeJson(options.output.json, {{"rows", rows}});
  if (options.output.quiet) return;
  std::printf("%s", tableText({{"scene", "scene"},
                               {"triangles", "triangles", "%.0f"},
                               {"variant", "technique"},
                               {"build_s", "built in, s", "%.1f"},
                               {"cubes", "cubes", "%.0f"},
                               {"entries", "entries", "%.0f"},
                               {"looked_up_mib", "looked up, MiB", "%.1f"},
                               {"kept_mib", "kept, MiB", "%.0f"},
                               {"indirect_ms", "indirect light, ms", "%.1f"},
                               {"share", "share of the other's", "%.3f"},
                               {"frame_ms", "frame, ms", "%.0f"},
                               {"rmse_share", "RMSE over mean", "%.2f %%", 100},
                               {"rel_mse", "relMSE less the truth's noise", "%.1e"}},
                              rows)
                        .c_str());
}

} // namespace lambent
