// lambent accuracy SCENE: what approximations cost in error. Shadow maps of VPLs here; with --curve see
// accuracy_curve.cpp.
#include "tools/lambent/accuracy.h"

#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"

#include <cstdio>

namespace lambent {

namespace {

void accuracy(const AccuracyOptions& options) {
  const auto stage = openStage(options.launch);
  say(*stage, options.output.quiet);
  GlContext context = GlContext::headless();
  GiFrame gi(stage->settings, stage->seed);
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

void declareAccuracy(CLI::App& app) {
  auto options = std::make_shared<AccuracyOptions>();
  CLI::App* command = app.add_subcommand("accuracy", "what the approximations cost in error: shadow maps of virtual "
                                                     "lights, or with --curve patches and clusters");
  command->add_option("SCENE", options->launch.scene, "glTF or shot file")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output, "--curve: folder for plot, table and pictures (default out/accuracy)");
  command->add_option("--lights", options->slots, "virtual lights to compare")->check(CLI::Range(1, 32768));
  command->add_option("--points", options->points, "visible points to compare at")->check(CLI::Range(1, 1000000));
  command
      ->add_option(
          "--curve", options->curve,
          "error against threshold: patches (multires-gather; paper 3, fig. 9) or clusters (isr and hisr; fig. 13)")
      ->check(CLI::IsMember({"patches", "clusters"}));
  command->callback([options] { options->curve.empty() ? accuracy(*options) : accuracyCurve(*options); });
}

} // namespace lambent
