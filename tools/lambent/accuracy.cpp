// lambent accuracy SCENE: what approximations cost in error. Shadow maps of VPLs, and pictures of one view under
// changing settings, compared with path tracing or with one among them: --convergence, --gathers, --light, --direct,
// --volume, --cube. The other forms: accuracy_figures.cpp, reflective.cpp, accuracy_report.cpp.
#include "tools/lambent/accuracy.h"

#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "tools/lambent/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// But the brightest hundredth of the pixels.
Value biasOfMost(const Outcome& o) {
  return imageError(o.run.image, o.study.truth, allButBrightest(o.study.truth, 0.01)).bias;
}
constexpr TableColumn kBiasOfMost{"bias_most", "but the brightest 1 %", "%+.1f %%", 100};

void accuracyMaps(const AccuracyOptions& options) {
  const auto opened = openAndSay(options.launch, options.output.quiet);
  GlContext context = GlContext::headless();
  Viewer gi(opened->settings, opened->seed);
  const SceneView view = opened->at(0);
  {
    Progress progress("placing virtual lights", options.output.quiet);
    gi.run(view, [&](int done, int total) { progress.update(done, total); });
  }
  Progress progress("comparing shadow maps", options.output.quiet);
  const ShadowAgreement a = gi.compareShadowMaps(view, options.slots, options.points,
                                                 [&](int done, int total) { progress.update(done, total); });
  writeJson(options.output.json,
            Value::of("pairs", a.pairs, "resolution", opened->settings.shadow.resolution, "makers_disagree", a.makers,
                      "raster_against_rays", a.rasterAgainstRays, "cast_against_rays", a.castAgainstRays));
  if (options.output.quiet) return;
  std::printf("shadow maps of %d virtual lights at %d texels, %llu pixel pairs, shares of unshadowed contribution\n",
              options.slots, opened->settings.shadow.resolution, (unsigned long long)a.pairs);
  std::printf("  raster and ray-cast maps disagree  %6.3f %%\n", 100 * a.makers);
  std::printf("  raster maps against a ray a pair   %6.3f %%\n", 100 * a.rasterAgainstRays);
  std::printf("  ray-cast maps against a ray a pair %6.3f %%\n", 100 * a.castAgainstRays);
}

/// How the set of virtual lights converges (paper 1, 5.4).
void accuracyConvergence(const AccuracyOptions& options) {
  needClamp(options);
  Assignments set = kPlain;
  set.emplace_back("vpl.visibility", "rays");
  Study study(options, options.launch.scene, {.size = "64x36", .set = set});
  const double ofTruth = study.trace(4096, ReferenceBuffer::Irradiance, true).image.relativeError;
  const std::vector<double> counts = options.quick ? std::vector<double>{64, 256} : std::vector{512.0, 2048.0, 8192.0};
  const size_t seeds = size_t(options.seeds.value_or(options.quick ? 1 : 3));
  std::vector<Variant> variants;
  for (const char* density : {"cells", "knn"})
    for (double vpls : counts)
      variants.push_back(study.variant(density, {{"smc.density", density}, {"smc.vpls", format("%g", vpls)}}));
  const std::vector<Measured> runs = study.draw(seeded(variants, int(seeds)), Buffer::Irradiance);

  Value rows, exponents;
  std::vector<double> errors;
  for (size_t i = 0; i < variants.size(); ++i) {
    Value& row = rows.add(Value::of("density", variants[i].name, "vpls", variants[i].settings.smc.vpls));
    double square = 0;
    for (const Measured& m : std::span(runs).subspan(i * seeds, seeds)) {
      const ImageError e = study.outcome(m).error;
      square += e.rmseShare() * e.rmseShare() / double(seeds);
      row["bias"].add(e.bias);
    }
    // What the truth does not know is no error of the lights.
    errors.push_back(std::sqrt(std::max(square - ofTruth * ofTruth, 1e-12)));
    row["rmse_share"] = errors.back();
    if (errors.size() < counts.size()) continue;
    exponents[variants[i].name] = exponentOf(counts, errors);
    errors.clear();
  }
  study.report({{{"density", "density"}}, {{"vpls", "N"}}, kBias, kRmseShare}, rows, Value::of("exponents", exponents));
  for (const auto& [density, exponent] : exponents.fields())
    if (!options.output.quiet) std::printf("%s: RMSE falls as N^%.2f\n", density.c_str(), exponent.number());
}

/// Ways to gather the same virtual lights: time, and error against every light at every pixel.
void accuracyGathers(const AccuracyOptions& options) {
  Study study(options, options.launch.scene,
              {.size = "320x180", .set = {{"gather.near", "0"}, {"history.frames", "0"}}}); // the same for all of them
  std::vector<Variant> variants;
  for (const char* mode : {"full", "interleaved", "multires-interleaved", "multires"})
    variants.push_back(study.variant(mode, {{"gather.mode", mode}}));
  variants.insert(
      variants.begin() + 3,
      study.variant("multires-interleaved, multires.normal=0.7, multires.depth=0.1",
                    {{"gather.mode", "multires-interleaved"}, {"multires.normal", "0.7"}, {"multires.depth", "0.1"}}));
  for (Variant& v : variants) v.settings.effects[EffectId::Redraw] = EffectMode::On;
  RunPlan plan = stillPlan(*study.opened, Buffer::Irradiance, options.quick ? 3 : 8, options.quick ? 1 : 2);
  plan.inTurn = true;
  const std::vector<Measured> runs = run(variants, plan, "drawing", options.output.quiet);
  study.compareWith(runs[0].image);
  const std::vector<Column> columns{{{"gather", "gather"}, variantName},
                                    {{"ms", "ms", "%.0f"},
                                     [](const Outcome& o) -> Value {
                                       using enum StageId;
                                       double ms = 0;
                                       for (StageId s : {Patches, Stencil, Gather, Upsample, Filter})
                                         ms += o.run.ms(s).median;
                                       return ms;
                                     }},
                                    {{"ratio", "of interleaved", "%.2f"}},
                                    kRmseShare,
                                    kRelMse};
  Value rows = study.rows(columns, std::span(runs).subspan(1));
  for (Value& row : rows.items()) row["ratio"] = row["ms"].number() / rows.items()[0]["ms"].number();
  study.report(columns, rows);
}

void needShot(const AccuracyOptions& options, const Study& study) {
  if (options.frame > 0 && !study.opened->shot) throw InputError(study.launch.scene, "is no shot (--frame needs one)");
}

/// Bias and error of indirect irradiance against path tracing, as set, and with every light at every pixel by rays.
void accuracyLight(const AccuracyOptions& options) {
  Study study(options, options.launch.scene, {.size = "160x90"});
  needShot(options, study);
  study.trace(2048, ReferenceBuffer::Irradiance, false, {}, options.frame);
  if (options.apart) return accuracyApart(options, study);
  const int averaged = std::max(1, study.opened->settings.history.frames),
            seeds = options.seeds.value_or(options.quick ? 1 : 3);
  std::vector<std::pair<Variant, int>> ways{{study.variant("as set"), averaged}}; // and frames of a still view
  if (!options.alone) ways.emplace_back(study.variant("one picture", {{"history.frames", "0"}}), 1);
  if (!options.alone && options.frame == 0) // as many near rays as averaged pictures have
    ways.emplace_back(
        study.variant("all, rays", {{"gather.mode", "full"}, {"vpl.visibility", "rays"}, {"gather.near", "32"}}), 1);
  const std::vector<Column> columns{
      {{"lights", "lights"}, variantName},
      {{"seed", "seed"}, [](const Outcome& o) -> Value { return o.run.variant.seed; }},
      kBias,
      {kBiasOfMost, biasOfMost},
      {{"blocks", "blocks within 6 %", "%.0f %%", 100},
       [](const Outcome& o) -> Value { return blocksWithin(o.run.image, o.study.truth, 10, 0.06); }},
      kRelMse,
      {{"ms", "ms a frame", "%.0f"}, [](const Outcome& o) -> Value { return steadyMs(o.run.frames); }},
      {{"paths_ms", "ms of path tracing to that error", "%.0f"},
       [](const Outcome& o) -> Value { return pathsMs(*o.study.traced, o.error.relMse); }},
      {{"times", "times the frame", "%.1f"}}};
  Value rows = Value::list();
  for (const auto& [variant, frames] : ways) {
    const std::vector<Variant> variants = seeded({variant}, seeds);
    for (const Measured& m : options.frame > 0 ? study.drawUpTo(options.frame, variants, Buffer::Irradiance)
                                               : study.draw(variants, Buffer::Irradiance, frames)) {
      Value& row = rows.add(study.row(columns, m));
      if (row.has("ms") && row.has("paths_ms")) row["times"] = row["paths_ms"].number() / row["ms"].number();
    }
  }
  study.report(columns, rows);
}

/// Bias and error of direct light against path tracing, as set, and by other means: still, after as many frames as are
/// averaged, or in a frame of a shot.
void accuracyDirect(const AccuracyOptions& options) {
  Study study(options, options.launch.scene, {.size = "320x180", .set = {{"effects.indirect", "off"}}});
  if (!study.opened->settings.direct.on) throw InputError("settings", "direct light is off (--direct needs direct.on)");
  needShot(options, study);
  study.trace(256, ReferenceBuffer::Direct, false, {}, options.frame);
  std::vector<Variant> variants{
      study.variant("as set"), study.variant("maps", {{"direct.soft", "maps"}}),
      study.variant("maps, lamps by patches", {{"direct.soft", "maps"}, {"shadow.emitters", "patches"}})};
  if (options.alone) variants.resize(1);
  const std::vector<Column> columns{
      {{"shadows", "shadows"}, variantName},
      {{"rays", "rays a frame", "%.0f"},
       [](const Outcome& o) -> Value {
         const FrameStats& last = o.run.frames.back();
         return last.raysShadows.occlusion + last.raysArea.occlusion + last.raysSoft.occlusion + last.raysSoft.closest;
       }},
      kBias,
      {kBiasOfMost, biasOfMost},
      kRmseShare,
      kRelMse,
      {{"truth_rel_mse", "of it the truth's", "%.4f"},
       [](const Outcome& o) -> Value {
         return expectedRelMse(o.study.traced->image.mean, o.study.traced->image.error);
       }},
      {{"ms", "ms a frame", "%.0f"}, [](const Outcome& o) -> Value { return steadyMs(o.run.frames); }}};
  const int averaged = std::max(1, study.opened->settings.direct.frames);
  study.report(columns, study.rows(columns, options.frame > 0 ? study.drawUpTo(options.frame, variants, Buffer::Direct)
                                                              : study.draw(variants, Buffer::Direct, averaged)));
}

/// Light propagation volumes by what their settings take, next to lights that every pixel gathers.
void accuracyVolume(const AccuracyOptions& options) {
  Study study(options, options.launch.scene, {.size = "160x90"});
  study.trace(1024, ReferenceBuffer::Irradiance);
  std::vector<Variant> variants{study.variant("smc", {}, "smc")};
  if (!study.opened->at(0).lights.empty()) variants.push_back(study.variant("rsm", {}, "rsm"));
  for (const Assignments& set : std::vector<Assignments>{{},
                                                         {{"lpv.cells", "8"}, {"lpv.steps", "16"}},
                                                         {{"lpv.cells", "32"}, {"lpv.steps", "64"}},
                                                         {{"lpv.cells", "64"}, {"lpv.steps", "128"}},
                                                         {{"lpv.steps", "16"}},
                                                         {{"lpv.steps", "64"}},
                                                         {{"lpv.occlusion", "off"}},
                                                         {{"lpv.lobes", "face"}},
                                                         {{"smc.vpls", "512"}},
                                                         {{"smc.vpls", "8192"}},
                                                         {{"smc.bounces", "1"}}}) {
    std::string name = "lpv";
    for (const auto& [setting, value] : set) name += ", " + setting + "=" + value;
    variants.push_back(study.variant(name, set, "lpv"));
    if (options.quick && !set.empty()) break;
  }
  const std::vector<Column> columns{{{"technique", "technique"}, variantName},
                                    kBias,
                                    kRmseShare,
                                    kRelMse,
                                    {{"steps_ms", "steps, ms (shaders too)", "%.0f"},
                                     [](const Outcome& o) -> Value { return o.run.ms(StageId::Propagate).median; }},
                                    {{"rays", "rays of the grid", "%.0f"}, [](const Outcome& o) -> Value {
                                       return o.run.frames.back().raysVolume.occlusion;
                                     }}};
  study.report(columns, study.rows(columns, study.draw(variants, Buffer::Irradiance)));
}

/// Layered depth cubes by their texels: against a ray for every pixel and light of the same lights, which is what
/// texels cost, and against path tracing.
void accuracyCube(const AccuracyOptions& options) {
  Study study(options, options.launch.scene, {.size = "320x180"});
  study.trace(options.quick ? 4 : 256, ReferenceBuffer::Irradiance);
  const Assignments lights = {{"gather.near", "0"}, {"filter.on", "off"}, {"history.frames", "0"}};
  std::vector<Variant> variants;
  const auto add = [&](const std::string& name, const Assignments& set, const char* technique) {
    Assignments all = lights;
    all.insert(all.end(), set.begin(), set.end());
    variants.push_back(study.variant(name, all, technique));
  };
  add("every pixel and light", {{"vpl.visibility", "rays"}}, "ir");
  for (const std::string texels : {"16", "32", "64", "128", "256", "512"})
    if (!options.quick || variants.size() < 3) add("ibrr, " + texels + "²", {{"cube.resolution", texels}}, "ibrr");
  const std::vector<Measured> runs = study.draw(variants, Buffer::Irradiance);
  const std::vector<Column> columns{{{"technique", "technique"}, variantName},
                                    {{"texel_rel_mse", "relMSE by texels", "%.2e"}},
                                    {{"texel_bias", "bias by texels", "%+.2f %%", 100}},
                                    kBias,
                                    kRmseShare,
                                    kRelMse,
                                    {{"built_s", "built in, s", "%.1f"},
                                     [](const Outcome& o) -> Value { return o.run.ms(StageId::Cube).median / 1000; }},
                                    {{"looked_up_mib", "looked up, MiB", "%.1f"}, [](const Outcome& o) -> Value {
                                       return double(o.run.frames.back().cubeBytes) / (1 << 20);
                                     }}};
  Value rows = study.rows(columns, runs);
  for (size_t i = 1; i < runs.size(); ++i) {
    const ImageError error = imageError(runs[i].image, runs[0].image);
    rows.items()[i]["texel_rel_mse"] = error.relMse;
    rows.items()[i]["texel_bias"] = error.bias;
  }
  study.report(columns, rows);
}

void accuracy(AccuracyOptions& o) {
  if (o.form != accuracyReport && o.scenes.size() > 1)
    throw InputError(o.scenes[1], "one scene or shot is enough (several go with --report)");
  o.launch.scene = o.scenes[0];
  if (o.apart && (o.form != accuracyLight || o.frame == 0))
    throw InputError("command line", "--apart takes a frame in motion apart, and needs --light and --frame");
  const bool reflective = std::ranges::count(reflectiveFigureNames(), o.figure) > 0;
  if (const std::string& technique = o.launch.technique; !technique.empty()) {
    if (!o.curve.empty()) throw InputError("--technique " + technique, "--curve has techniques of its own");
    if (reflective || o.figure == "1.3" || o.figure == "1.5" || o.figure == "5.5")
      throw InputError("--technique " + technique, "--figure " + o.figure + " has techniques of its own");
    needSampledLights(technique);
  }
  if (o.quick && o.curve.empty() && !reflective && o.form != accuracyReport) useFewLights(o);
  if (!o.curve.empty()) return accuracyCurve(o);
  if (reflective) return reflectiveFigure(o);
  if (!o.figure.empty()) return pathFigure(o);
  (o.form ? o.form : accuracyMaps)(o);
}

} // namespace

void declareAccuracy(CLI::App& app) {
  auto o = std::make_shared<AccuracyOptions>();
  Command command(app, "accuracy",
                  "what approximations cost in error: shadow maps of virtual lights, or a form of its own");
  command.reads("SCENE", o->scenes, "glTF or shot file; several with --report", true);
  command.launch(o->launch);
  command.output(o->output, "--report, --curve, --figure: folder (default out/accuracy, out/figure-N)");
  command.number("--lights", &o->slots, 1, 32768, "virtual lights to compare");
  command.number("--points", &o->points, 1, 1000000, "visible points to compare at");
  const auto form = [&](const char* name, void (*form)(const AccuracyOptions&), const char* help) {
    command.flag(
        name, [o, form] { o->form = form; }, help);
  };
  command.beginForms();
  command.choice(
      "--curve", o->curve, {"patches", "clusters"},
      "error against threshold: patches (multires-gather; paper 3, fig. 9) or clusters (isr and hisr; fig. 13)");
  form("--convergence", accuracyConvergence,
       "every pixel against every VPL by rays, for N = 512, 2048, 8192 with both densities, against path "
       "tracing clamped alike (paper 1, 5.4)");
  form("--gathers", accuracyGathers, "ways to gather the same VPLs: time, and error against all at every pixel");
  form("--light", accuracyLight,
       "indirect light as set, averaged over pictures, against path tracing: bias, error, share of blocks that "
       "are right, frame time and path tracing's to the same error; beside it one picture, and every light at every "
       "pixel by rays");
  form("--direct", accuracyDirect,
       "direct light as set, averaged over frames, against path tracing: bias, error and frame time; beside it by "
       "shadow "
       "maps, and with lamps by patches");
  form("--volume", accuracyVolume,
       "light propagation volumes (technique lpv) by their settings, beside smc and rsm, against path tracing");
  form("--cube", accuracyCube,
       "layered depth cubes (technique ibrr) by their texels, against a ray for every pixel and light and against path "
       "tracing");
  form("--report", accuracyReport,
       "what accuracy costs in time: every setting that trades one for the other, alone and together, and "
       "every technique, along each shot and standing at its end: front, curves, pictures on one page "
       "(index.html), points.csv; interrupted, the same command goes on");
  std::vector<std::string> figures = pathFigureNames();
  for (const std::string& name : reflectiveFigureNames()) figures.push_back(name);
  command.choice(
      "--figure", o->figure, figures,
      "of a paper. 1.3: what changes between two frames of a shot (--frame), and where lights are placed; 1.5: "
      "frames in which light comes into sight, with resampled candidates and without; 1.8: visibility by maps "
      "and rays against path tracing; 1.9: resolution of shadow "
      "maps against rays; 1.10: N = 2000, 8000, 40000 by rays against path tracing. 2.table-1, 2.8: frame "
      "rate by finest patches and VPLs; 2.7, 2.9: by the threshold of normals, and detail put back; 2.6: glossy. 3.8: "
      "four techniques; 3.10: "
      "as a shot's light moves; 3.11, 3.12: isr and hisr by thresholds and finest clusters; 3.combined: "
      "error of patches and clusters. 5.5: layered depth cubes by their texels against rays. criterion, upsampling: "
      "ours beside those of papers 2 and 3");
  command.endForms();
  command.number("--spp", &o->samples, 2, 1 << 24,
                 "paths per pixel of the truth (4096; --report, --light 2048, --direct 256, --figure 1024)");
  command.number("--clamp", &o->clamp, 0, 0,
                 "--convergence, --figure: largest geometry term, of VPLs and of path tracing, 1/m^2");
  command.number("--seeds", &o->seeds, 1, 1000, "--convergence, --light: so many (3); --report (1)");
  command.number("--frame", &o->frame, 1, 1000000,
                 "--light, --direct, --figure 1.3, 1.5: of a shot, with all that moves before it");
  command.flag("--joint", o->joint, "--report: only what presets are chosen among");
  command.flag("--alone", o->alone, "--light, --direct: only as set, nothing beside it");
  command.flag(
      "--apart", o->apart,
      "--light --frame: the parts of the squared error instead: near light, reconstruction, choice of lights, maps, "
      "history, set");
  command.flag("--quick", o->quick, "small and rough, to try whether it runs");
  command.run([o] { accuracy(*o); });
}

} // namespace lambent
