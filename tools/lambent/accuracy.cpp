// lambent accuracy SCENE: what approximations cost in error. Shadow maps of VPLs here; with --curve see
// accuracy_curve.cpp, with the other forms accuracy_tables.cpp.
#include "tools/lambent/accuracy.h"

#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/plan/techniques.h"
#include "tools/lambent/reflective_figures.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace {

void accuracy(const AccuracyOptions& options) {
  const auto stage = openLaunch(options.launch);
  say(*stage, options.output.quiet);
  GlContext context = GlContext::headless();
  Viewer gi(stage->settings, stage->seed);
  const SceneView view = stage->at(0);
  {
    Progress progress("placing virtual lights", options.output.quiet);
    gi.run(view, [&](int done, int total) { progress.update(done, total); });
  }
  Progress progress("comparing shadow maps", options.output.quiet);
  const ShadowAgreement a = gi.compareShadowMaps(view, options.slots, options.points,
                                                 [&](int done, int total) { progress.update(done, total); });
  writeJson(options.output.json, {{"pairs", a.pairs},
                                  {"resolution", stage->settings.shadow.resolution},
                                  {"makers_disagree", a.makers},
                                  {"raster_against_rays", a.rasterAgainstRays},
                                  {"cast_against_rays", a.castAgainstRays}});
  if (options.output.quiet) return;
  std::printf("shadow maps of %d virtual lights at %d texels, %llu pixel pairs, shares of unshadowed contribution\n",
              options.slots, stage->settings.shadow.resolution, (unsigned long long)a.pairs);
  std::printf("  raster and ray-cast maps disagree  %6.3f %%\n", 100 * a.makers);
  std::printf("  raster maps against a ray a pair   %6.3f %%\n", 100 * a.rasterAgainstRays);
  std::printf("  ray-cast maps against a ray a pair %6.3f %%\n", 100 * a.castAgainstRays);
}

} // namespace

void needClamp(const AccuracyOptions& options) {
  if (!(options.clamp.value_or(0) > 0))
    throw InputError("--clamp", "is needed here (largest geometry term on both sides, in 1/m^2: --clamp 10)");
}

RunPlan stillPlan(LaunchContext& stage, Progress& progress, Buffer buffer) {
  RunPlan plan = planOf(stage, progress, 1);
  plan.view = [&stage](int) { return stage.at(0); };
  plan.inTurn = false;
  plan.picture = buffer;
  return plan;
}

void declareAccuracy(CLI::App& app) {
  auto options = std::make_shared<AccuracyOptions>();
  CLI::App* command =
      app.add_subcommand("accuracy", "what approximations cost in error: shadow maps of virtual lights, "
                                     "or a form of its own");
  command->add_option("SCENE", options->scenes, "glTF or shot file; several with --report")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output,
                   "--report, --curve, --figure: folder (default out/accuracy, out/figure-N)");
  command->add_option("--lights", options->slots, "virtual lights to compare")->check(CLI::Range(1, 32768));
  command->add_option("--points", options->points, "visible points to compare at")->check(CLI::Range(1, 1000000));
  CLI::App* forms = command->add_option_group("Forms", "at most one")->require_option(0, 1);
  forms
      ->add_option(
          "--curve", options->curve,
          "error against threshold: patches (multires-gather; paper 3, fig. 9) or clusters (isr and hisr; fig. 13)")
      ->check(CLI::IsMember({"patches", "clusters"}));
  forms->add_flag("--convergence", options->convergence,
                  "every pixel against every VPL by rays, for N = 512, 2048, 8192 with both densities, against path "
                  "tracing clamped alike (paper 1, 5.4)");
  forms->add_flag("--gathers", options->gathers,
                  "ways to gather the same VPLs: time, and error against all at every pixel");
  forms->add_flag(
      "--light", options->light,
      "indirect light as set, averaged over pictures, against path tracing: bias, error, share of blocks that "
      "are right, frame time and path tracing's to the same error; beside it one picture, and every light at every "
      "pixel by rays");
  forms->add_flag("--direct", options->direct,
                  "direct light as set against path tracing: bias and error; beside it maps without rays, and more "
                  "samples of what is emissive");
  forms->add_flag(
      "--volume", options->volume,
      "light propagation volumes (technique lpv) by their settings, beside smc and rsm, against path tracing");
  forms->add_flag("--report", options->report,
                  "what accuracy costs in time: every setting that trades one for the other, alone and together, and "
                  "every technique, along each shot and standing at its end: front, curves, pictures on one page "
                  "(index.html), points.csv; interrupted, the same command goes on");
  forms
      ->add_option(
          "--figure", options->figure,
          "of a paper. 1.8 (or 8): visibility by maps and rays against path tracing; 1.9: resolution of shadow "
          "maps against rays; 1.10: N = 2000, 8000, 40000 by rays against path tracing. 2.table-1, 2.8: frame "
          "rate by finest patches and VPLs; 2.7, 2.9: by the threshold of normals, and detail put back. 3.10: "
          "as a shot's light moves; 3.11, 3.12: isr and hisr by thresholds and finest clusters; 3.combined: "
          "error of patches and clusters. criterion, upsampling: ours beside those of papers 2 and 3")
      ->check(CLI::IsMember(figureNames()));
  command
      ->add_option("--spp", options->samples,
                   "paths per pixel of the truth (4096; --report, --light 2048, --direct 256, --figure 1024)")
      ->check(CLI::Range(2, 1 << 24));
  command->add_option("--clamp", options->clamp,
                      "--convergence, --figure: largest geometry term, of VPLs and of path tracing, 1/m^2");
  command->add_option("--seeds", options->seeds, "--convergence, --light: so many (3); --report (1)")
      ->check(CLI::Range(1, 1000));
  command->add_option("--frame", options->frame, "--light: of a shot, with all that moves before it")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--joint", options->joint, "--report: only what presets are chosen among");
  command->add_flag("--alone", options->alone, "--light, --direct: only as set, nothing beside it");
  command->add_flag("--quick", options->quick, "small and rough, to try whether it runs");
  command->callback([options] {
    AccuracyOptions& o = *options;
    if (!o.report && o.scenes.size() > 1)
      throw InputError(o.scenes[1], "one scene or shot is enough (several go with --report)");
    o.launch.scene = o.scenes[0];
    if (const std::string& technique = o.launch.technique; !technique.empty()) {
      if (!o.curve.empty()) throw InputError("--technique " + technique, "--curve has techniques of its own");
      if (std::ranges::count(reflectiveFigureNames(), o.figure) > 0)
        throw InputError("--technique " + technique, "--figure " + o.figure + " has techniques of its own");
      if (!needsOf(techniqueByName(technique)).sampled())
        throw InputError("--technique " + technique, "has no sampled lights (smc, ir, mir and tcas have)");
    }
    if (!o.curve.empty()) return accuracyCurve(o);
    if (o.convergence) return accuracyConvergence(o);
    if (o.gathers) return accuracyGathers(o);
    if (o.light) return accuracyLight(o);
    if (o.direct) return accuracyDirect(o);
    if (o.volume) return accuracyVolume(o);
    if (o.report) return accuracyReport(o);
    if (!o.figure.empty()) return accuracyFigure(o);
    accuracy(o);
  });
}

} // namespace lambent
