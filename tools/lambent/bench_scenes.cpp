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
#include <cmath>
#include <cstdio>
#include <set>

namespace lambent {

namespace {

constexpr TableColumn kLessNoise{"rel_mse", "relMSE less the truth's noise", "%.1e"};
/// What the truth does not know is no error of the picture.
Value relMseLessNoise(const Outcome& o) {
  const ReferenceImage& truth = o.study.traced->image;
  return std::max(o.error.relMse - expectedRelMse(truth.mean, truth.error), 0.0);
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

constexpr size_t kPredecessor = 2; // of the rows below

/// Patches as set; those of paper 4 (quarters whose answers differ by one bit), whose quarters ask 16 samples, or more,
/// up to as many as the predecessor knows, that differ by two bits, or that are samples at their centres; those of
/// Nichols et al. 2010 (nine patches whose answers differ by one bit, or by four, upsampling level by level); every
/// pixel with 64 rays, and with the 16 that a patch of paper 4 knows.
std::vector<Variant> areaVariants(const LaunchContext& opened) {
  const auto paper = [&](const char* name, int rays, const char* threshold = "1", const char* upsample = "rbf") {
    return variantOf(opened, name,
                     {{"area.refinement", "sub-fragments"},
                      {"area.threshold", threshold},
                      {"area.rays", std::to_string(rays)},
                      {"area.gradient", std::to_string(rays / 4)}, // published: 4 of 16
                      {"area.extra", "on"},
                      {"area.upsample", upsample}});
  };
  const auto everyPixel = [&](const char* name, const char* rays) {
    return variantOf(opened, name, {{"area.refinement", "neighbours"}, {"area.rays", rays}, {"multires.depth", "0"}});
  };
  const auto predecessor = [&](const char* name, const char* threshold) {
    return variantOf(opened, name,
                     {{"area.refinement", "neighbours"},
                      {"area.threshold", threshold},
                      {"area.rays", "16"},
                      {"area.gradient", "0"},
                      {"area.extra", "off"},
                      {"area.upsample", "bilinear"}});
  };
  std::vector<Variant> variants{variantOf(opened, "as set"),
                                paper("paper 4", 16),
                                predecessor("predecessor", "1"),
                                paper("paper 4 with 32 samples", 32),
                                paper("paper 4 with 64 samples", 64),
                                paper("paper 4 by two bits", 16, "2"),
                                paper("paper 4, centres", 16, "1", "rbf-centres"),
                                paper("paper 4, bilinear", 16, "1", "bilinear"),
                                predecessor("predecessor, 4 bits", "4"),
                                everyPixel("every pixel", "16"),
                                everyPixel("every pixel, 16 samples", "4")};
  for (Variant& v : variants) {
    v.settings.effects[EffectId::Indirect] = EffectMode::Off;
    v.settings.effects[EffectId::Redraw] = EffectMode::On;
    v.settings.shadow.emitters = EmitterShadows::Patches;
  }
  return variants;
}

/// The truth of a view: 1024 rays to the lamps from every pixel. Pictures lose what glows, and pixels where rasteriser
/// and rays see unlike surfaces, along edges; so does the truth.
/// Returns the RMS of the truth's own noise over its mean.
double compareWithLamps(Study& study, std::span<Measured> runs, const SceneView& view, int rays, bool quiet) {
  const std::unique_ptr<Runner> drawn = wholeFrames(runs[0].variant);
  drawn->run(view);
  const Image distance = drawn->image(Buffer::Depth), normal = drawn->image(Buffer::Normal);
  LampTruth truth = traceLamps(view, rays);
  size_t apart = 0;
  double light = 0, noise = 0;
  for (size_t i = 0; i < truth.light.pixels.size(); ++i) {
    const float here = truth.distance.pixels[i].x;
    const bool same = std::abs(distance.pixels[i].x - here) < 0.01f * here &&
                      glm::dot(normal.pixels[i], truth.normal.pixels[i]) > 0.99f;
    apart += here > 0 && !same;
    if (here > 0 && same) {
      light += double(luminance(truth.light.pixels[i]));
      noise += double(luminance(truth.noise.pixels[i]) * luminance(truth.noise.pixels[i]));
      continue;
    }
    truth.light.pixels[i] = vec3(0);
    for (Measured& run : runs) run.image.pixels[i] = vec3(0);
  }
  if (!quiet) std::printf("%zu of %zu pixels lie on edges and are left out\n", apart, truth.light.pixels.size());
  study.compareWith(truth.light);
  return light > 0 ? std::sqrt(noise * double(truth.light.pixels.size())) / light : 0;
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
    {{"truth_rmse_share", "the truth's own", "%.2f %%", 100}},
    {{"rel_mse", "relMSE", "%.1e"}},
    {{"fragments_share", "share of the predecessor's fragments", "%.2f"}},
    {{"ms_share", "of its time", "%.2f"}}};

/// Milliseconds of a frame that go to indirect light.
double indirectMs(const FrameStats& stats) {
  using enum StageId;
  double ms = 0;
  for (size_t s = size_t(Scene) + 1; s < size_t(Composite); ++s)
    if (s < size_t(Surfaces) || s > size_t(AreaLight)) ms += stats.ms(StageId(s)); // between them: direct light
  return ms;
}

/// The technique of the settings; cubes of several resolutions, with few lights and many; then paper 5's table 1, whose
/// hemicubes are as wide as the cube.
std::vector<Variant> cubeVariants(const LaunchContext& opened, bool quick) {
  Variant other = variantOf(opened, techniqueOf(opened.settings).name);
  other.settings.effects[EffectId::Redraw] = EffectMode::On;
  std::vector<Variant> all{other};
  Variant cube = other;
  applyTechnique(cube.settings, "ibrr");
  // Not the faster of both makers in each scene: scenes are compared.
  if (cube.settings.hemicubes.maker == CubeMaker::Auto) cube.settings.hemicubes.maker = CubeMaker::Rays;
  const auto add = [&](int resolution, int levels, int lights, CubeVisibility sights) {
    Variant& v = all.emplace_back(cube);
    v.settings.cube.resolution = v.settings.cube.hemicube = resolution;
    v.settings.cube.levels = levels;
    v.settings.cube.visibility = sights;
    v.settings.smc.vpls = lights;
    const std::string tree = levels > 0 ? format(" in %d levels", levels) : "";
    v.name = format("ibrr %d", resolution) + tree +
             format(", %d lights, %s", lights, sights == CubeVisibility::Rays ? "rays" : "hemicubes");
  };
  using enum CubeVisibility;
  if (quick) {
    add(16, 0, 64, Rays);
    add(16, 2, 64, Rays);
    add(16, 0, 64, Hemicubes);
    return all;
  }
  for (const int resolution : {128, 256, 512}) add(resolution, 0, 200, Rays);
  add(32, 4, 200, Rays);
  add(128, 0, 751, Rays);
  add(128, 0, 2048, Rays);
  for (const int resolution : {128, 256, 512, 1024}) add(resolution, 0, 184, Hemicubes);
  for (const int lights : {200, 371, 589, 751}) add(256, 0, lights, Hemicubes);
  return all;
}

const std::vector<Column> kCubeColumns{
    {{"scene", "scene"}},
    {{"triangles", "triangles", "%.0f"}},
    {{"variant", "technique"}, variantName},
    {{"build_s", "built in, s", "%.1f"}},
    {{"near_s", "near light, s", "%.1f"}},
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
    FrameStats first;
    try {
      first = runner->run(view);
    } catch (const RunError& e) { // a cube that this machine has no memory for
      if (interrupted || own) throw;
      std::fprintf(stderr, "warning: %s: %s\n", variants[i].name.c_str(), e.what());
      continue;
    }
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
    row["build_s"] = first.ms(StageId::Cube) / 1000;
    row["near_s"] = first.ms(StageId::NearLight) / 1000;
    row["share"] = row["indirect_ms"].number() / turn.of(indirectMs).median;
    row["entries"] = first.cubeEntries;
    row["cubes"] = first.cubes;
    row["looked_up_mib"] = double(first.cubeBytes) / (1 << 20);
    row["kept_mib"] = double(first.cubeKeptBytes) / (1 << 20);
  }
}

/// What paper 5's table 1 claims: the same time whatever the triangles, and little more to look up with more lights.
Value cubeClaims(const Value& rows) {
  Value claims;
  const auto most = [&](const std::string& variant, const char* column) {
    double least = 1e300, greatest = 0;
    for (const Value& row : rows.items())
      if (row["variant"].text() == variant && row.has("build_s")) {
        least = std::min(least, row[column].number());
        greatest = std::max(greatest, row[column].number());
      }
    return greatest / least;
  };
  const auto lookedUp = [&](const std::string& scene, int lights) {
    const std::string variant = format("ibrr 256, %d lights, hemicubes", lights);
    for (const Value& row : rows.items())
      if (row["scene"].text() == scene && row["variant"].text() == variant) return row["looked_up_mib"].number();
    return 0.0; // left out, for want of memory
  };
  std::set<std::string> scenes, told;
  for (const Value& row : rows.items()) scenes.insert(row["scene"].text());
  const auto scenesOf = [&](const std::string& variant) {
    return std::ranges::count_if(rows.items(), [&](const Value& row) { return row["variant"].text() == variant; });
  };
  for (const Value& row : rows.items()) {
    const std::string variant = row["variant"].text();
    if (!row.has("build_s") || scenesOf(variant) < 2 || !told.insert(variant).second) continue;
    Value& claim = claims.add(Value::of("variant", variant));
    claim["build_ratio"] = most(variant, "build_s");
    claim["look_up_ratio"] = most(variant, "indirect_ms");
  }
  for (const std::string& scene : scenes)
    if (const double few = lookedUp(scene, 200), many = lookedUp(scene, 751); few > 0 && many > 0)
      claims.add(Value::of("scene", scene))["looked_up_ratio"] = many / few;
  return claims;
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
      const double noise = compareWithLamps(study, runs, plan.view(0),
                                            options.samples.value_or(options.quick ? 64 : 1024), options.output.quiet);
      Value own = study.rows(kAreaColumns, runs);
      for (size_t i = 0; i < own.size(); ++i) {
        Value& row = own.items()[i];
        const Value& before = own.items()[kPredecessor];
        row["scene"] = nameOf(file);
        row["truth_rmse_share"] = noise;
        row["lamp"] = scale == 1 ? "as it is" : "a quarter as wide";
        for (const std::string what : {"fragments", "ms"})
          if (i != kPredecessor) row[what + "_share"] = row[what].number() / before[what].number();
        rows.add(row);
      }
    }
  }
  writeJson(options.output.json, Value::of("rows", rows));
  if (!options.output.quiet) std::printf("%s", tableText(kAreaColumns, rows).c_str());
}

void benchCube(const BenchOptions& options) {
  Value rows;
  for (const std::string& file : options.scenes) addCubeRows(options, file, rows);
  const Value claims = cubeClaims(rows);
  writeJson(options.output.json, Value::of("rows", rows, "claims", claims));
  if (options.output.quiet) return;
  std::printf("%s", tableText(kCubeColumns, rows).c_str());
  for (const Value& claim : claims.items())
    if (claim.has("variant"))
      std::printf("%s: %.2f to build and %.2f to look up, the most over the least of the scenes\n",
                  claim["variant"].text().c_str(), claim["build_ratio"].number(), claim["look_up_ratio"].number());
    else
      std::printf("%s: %.3f of the memory to look up with 751 lights, of that with 200\n",
                  claim["scene"].text().c_str(), claim["looked_up_ratio"].number());
}

} // namespace lambent
