// lambent bench --area SCENE..., --cube SCENE...: tables of papers 4 and 5, scene by scene. Direct light of emissive
// surfaces at patches of the picture, with lamps as they are and with lamps of a quarter of their width; the layered
// depth cube next to the technique of the settings. Errors against rays to the lamps, and against path tracing.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "gi/measure/lamp_truth.h"
#include "gi/measure/scaled_view.h"
#include "gi/plan/techniques.h"
#include "tools/lambent/bench.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace {

constexpr TableColumn kLessNoise{"rel_mse", "relMSE less the truth's noise", "%.1e"};
/// What the truth does not know is no error of the picture.
Value relMseLessNoise(const Outcome& o) {
  const ReferenceImage& truth = o.study.traced->image;
  return std::max(o.error.relMse - expectedRelMse(truth.mean, truth.error), 0.0);
}

void tell(const BenchOptions& options, const std::vector<Column>& columns, const Value& rows) {
  writeJson(options.output.json, Value::of("rows", rows));
  if (!options.output.quiet) std::printf("%s", tableText(columns, rows).c_str());
}

/// Views with all that glows scaled about the middle of its bounds, and without other lights.
class ScaledLamps {
 public:
  explicit ScaledLamps(float scale) : scale_(scale) {}

  SceneView of(SceneView view) {
    instances_.assign(view.instances.begin(), view.instances.end());
    for (InstanceView& in : instances_) {
      const Mesh& mesh = view.assets->meshes[in.mesh];
      const bool glows = std::ranges::any_of(mesh.primitives, [&](const Primitive& p) {
        return maxComponent(view.assets->materials[p.material].emission) > 0;
      });
      if (!glows || scale_ == 1) continue;
      const vec3 middle = in.boundsWorld.centre();
      mat4 scaled = glm::translate(mat4(1), middle);
      scaled = glm::translate(glm::scale(scaled, vec3(scale_)), -middle);
      in.worldFromObject = in.worldFromObjectBefore = scaled * in.worldFromObject;
      in.boundsWorld = in.boundsWorldBefore = transformed(mesh.boundsObject, in.worldFromObject);
    }
    view.instances = instances_;
    view.lights = {};
    view.sky = {};
    view.changes.camera = true; // so that no frame keeps the light of the one before
    return view;
  }

 private:
  float scale_;
  std::vector<InstanceView> instances_;
};

/// Patches as set; those of paper 4 (quarters whose answers differ by one bit); those of Nichols et al. 2010 (nine
/// patches whose answers do, upsampling level by level); every pixel (asks all rays, splits all).
std::vector<Variant> areaVariants(const LaunchContext& opened) {
  std::vector<Variant> variants{
      variantOf(opened, "as set"),
      variantOf(opened, "paper 4", {{"area.refinement", "sub-fragments"}, {"area.threshold", "1"}}),
      variantOf(opened, "predecessor",
                {{"area.refinement", "neighbours"},
                 {"area.threshold", "1"},
                 {"area.gradient", "0"},
                 {"area.extra", "off"},
                 {"area.upsample", "bilinear"}}),
      variantOf(opened, "every pixel", {{"area.refinement", "neighbours"}, {"multires.depth", "0"}})};
  for (Variant& v : variants) {
    v.settings.effects[EffectId::Indirect] = EffectMode::Off;
    v.settings.effects[EffectId::Redraw] = EffectMode::On;
    v.settings.shadow.emitters = EmitterShadows::Patches;
  }
  return variants;
}

/// The truth of a view: 1024 rays to the lamps from every pixel. Pictures lose what glows, and pixels where rasteriser
/// and rays see unlike surfaces, along edges; so does the truth.
void compareWithLamps(Study& study, std::span<Measured> runs, const SceneView& view, int rays, bool quiet) {
  const std::unique_ptr<Runner> drawn = wholeFrames(runs[0].variant);
  drawn->run(view);
  const Image distance = drawn->image(Buffer::Depth), normal = drawn->image(Buffer::Normal);
  LampTruth truth = traceLamps(view, rays);
  size_t apart = 0;
  for (size_t i = 0; i < truth.light.pixels.size(); ++i) {
    const float here = truth.distance.pixels[i].x;
    const bool same = std::abs(distance.pixels[i].x - here) < 0.01f * here &&
                      glm::dot(normal.pixels[i], truth.normal.pixels[i]) > 0.99f;
    apart += here > 0 && !same;
    if (here > 0 && same) continue;
    truth.light.pixels[i] = vec3(0);
    for (Measured& run : runs) run.image.pixels[i] = vec3(0);
  }
  if (!quiet) std::printf("%zu of %zu pixels lie on edges and are left out\n", apart, truth.light.pixels.size());
  study.compareWith(truth.light);
}

const std::vector<Column> kAreaColumns{
    {{"scene", "scene"}},
    {{"lamp", "lamp"}},
    {{"method", "patches"}, variantName},
    {{"fragments", "fragments", "%.0f"},
     [](const Outcome& o) -> Value {
       return o.run.of([](const FrameStats& s) { return double(s.areaFragments); }).median;
     }},
    {{"visibility_ms", "visibility, ms", "%.1f"},
     [](const Outcome& o) -> Value { return o.run.ms(StageId::AreaRays).median; }},
    {{"light_ms", "light, ms", "%.1f"}, [](const Outcome& o) -> Value { return o.run.ms(StageId::AreaLight).median; }},
    {{"ms", "both, ms", "%.1f"},
     [](const Outcome& o) -> Value {
       return o.run.ms(StageId::AreaRays).median + o.run.ms(StageId::AreaLight).median;
     }},
    kRmseShare,
    {{"rel_mse", "relMSE", "%.1e"}},
    {{"fragments_share", "share of the predecessor's fragments", "%.2f"}},
    {{"ms_share", "of its time", "%.2f"}}};

/// Milliseconds of a frame that go to indirect light.
double indirectMs(const FrameStats& stats) {
  using enum StageId;
  double ms = 0;
  for (size_t s = 0; s < size_t(Composite); ++s) ms += stats.ms(StageId(s));
  constexpr StageId kOthers[] = {Scene,  Surfaces,   LightMaps, Emitters, EmitterMaps,
                                 Direct, ShadowRays, AreaRays,  AreaLight};
  return ms - msOf(stats, kOthers);
}

/// Cubes of several resolutions, with few lights and many, by rays and by hemicubes; the technique of the settings
/// first.
std::vector<Variant> cubeVariants(const LaunchContext& opened, bool quick) {
  Variant other = variantOf(opened, techniqueOf(opened.settings).name);
  other.settings.effects[EffectId::Redraw] = EffectMode::On;
  std::vector<Variant> all{other};
  Variant cube = other;
  applyTechnique(cube.settings, "ibrr");
  const auto add = [&](int resolution, int levels, int lights, CubeVisibility sights) {
    Variant& v = all.emplace_back(cube);
    v.settings.cube.resolution = resolution;
    v.settings.cube.levels = levels;
    v.settings.cube.visibility = sights;
    v.settings.smc.vpls = lights;
    const std::string tree = levels > 0 ? format(" in %d levels", levels) : "";
    v.name = format("ibrr %d", resolution) + tree +
             format(", %d lights, %s", lights, sights == CubeVisibility::Rays ? "rays" : "hemicubes");
  };
  using enum CubeVisibility;
  const int standard = cube.settings.cube.resolution;
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

const std::vector<Column> kCubeColumns{
    {{"scene", "scene"}},
    {{"triangles", "triangles", "%.0f"}},
    {{"variant", "technique"}, variantName},
    {{"build_s", "built in, s", "%.1f"}},
    {{"cubes", "cubes", "%.0f"}},
    {{"entries", "entries", "%.0f"}},
    {{"looked_up_mib", "looked up, MiB", "%.1f"}},
    {{"kept_mib", "kept, MiB", "%.0f"}},
    {{"indirect_ms", "indirect light, ms", "%.1f"},
     [](const Outcome& o) -> Value { return o.run.of(indirectMs).median; }},
    {{"share", "share of the other's", "%.3f"}},
    {{"frame_ms", "frame, ms", "%.0f"}, [](const Outcome& o) -> Value { return frameMs(o.run); }},
    kRmseShare,
    {kLessNoise, relMseLessNoise}};

/// Frames of a camera that moves, in turn with those of the settings' technique.
void addCubeRows(const BenchOptions& options, const std::string& file, Value& rows) {
  Study study(options, file, {.size = "640x360"});
  study.trace(256, ReferenceBuffer::Irradiance);
  const SceneView still = study.opened->at(0);
  const std::vector<Variant> variants = cubeVariants(*study.opened, options.quick);
  const int frames = options.quick ? 2 : 16, settle = options.quick ? 1 : 64;
  Progress progress("measuring", options.output.quiet);
  std::unique_ptr<Runner> other; // of the settings' technique
  for (size_t i = 0; i < variants.size(); ++i) {
    const bool own = i == 0;
    Measured cube{variants[i]}, turn{variants[0]};
    std::unique_ptr<Runner> runner = wholeFrames(variants[i]);
    SceneView view = still;
    const FrameStats first = runner->run(view);
    view.changes = {false, false, false, false, false};
    // Light that is averaged over pictures has its time; a cube's is there.
    for (int f = 1; own && f < settle; ++f) runner->run(view);
    cube.image = runner->image(Buffer::Irradiance);
    if (own) other = std::move(runner);
    const float step = 0.002f * view.boundsWorld.diameter();
    for (int f = 0; f < frames; ++f) {
      view.changes.camera = true;
      view.camera.worldFromView[3] += view.camera.worldFromView[0] * (f % 8 < 4 ? step : -step);
      turn.frames.push_back(other->run(view));
      cube.frames.push_back((own ? other : runner)->run(view));
      if (interrupted) throw RunError("interrupted");
    }
    Value& row = rows.add(study.row(kCubeColumns, cube));
    row["scene"] = nameOf(file);
    row["triangles"] = trianglesOf(still);
    progress.update(int(i) + 1, int(variants.size()));
    if (own) continue;
    row["build_s"] = (first.ms(StageId::Cube) + first.ms(StageId::NearLight)) / 1000;
    row["share"] = row["indirect_ms"].number() / turn.of(indirectMs).median;
    row["entries"] = first.cubeEntries;
    row["cubes"] = first.cubes;
    row["looked_up_mib"] = double(first.cubeBytes) / (1 << 20);
    row["kept_mib"] = double(first.cubeKeptBytes) / (1 << 20);
  }
}

} // namespace

void benchArea(const BenchOptions& options) {
  refuseTechnique(options, "cannot be chosen with --area, which measures its own");
  Value rows;
  for (const std::string& file : options.scenes) {
    Study study(options, file, {.size = "640x360"});
    for (const float scale : {1.0f, 0.25f}) {
      RunPlan plan = stillPlan(*study.opened, Buffer::Direct, options.quick ? 2 : 6, 1);
      ScaledLamps lamps(scale);
      plan.view = [&, view = plan.view](int frame) { return lamps.of(view(frame)); };
      std::vector<Measured> runs = run(areaVariants(*study.opened), plan, "drawing", options.output.quiet);
      if (runs[0].frames.back().areaFragments == 0)
        throw InputError(file, "no light of an emissive surface reaches this view (another scene or view)");
      compareWithLamps(study, runs, plan.view(0), options.samples.value_or(options.quick ? 64 : 1024),
                       options.output.quiet);
      Value own = study.rows(kAreaColumns, runs);
      for (size_t i = 0; i < own.size(); ++i) {
        Value& row = own.items()[i];
        const Value& before = own.items()[2]; // the predecessor
        row["scene"] = nameOf(file);
        row["lamp"] = scale == 1 ? "as it is" : "a quarter as wide";
        for (const std::string what : {"fragments", "ms"})
          if (i < 2) row[what + "_share"] = row[what].number() / before[what].number();
        rows.add(row);
      }
    }
  }
  tell(options, kAreaColumns, rows);
}

void benchCube(const BenchOptions& options) {
  Value rows;
  for (const std::string& file : options.scenes) addCubeRows(options, file, rows);
  tell(options, kCubeColumns, rows);
}

} // namespace lambent
