// lambent render SCENE: one view → image.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "tools/lambent/commands.h"

#include <cstdio>

namespace lambent {

namespace {

struct RenderOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::string buffer = "beauty";
  int frames = 0; // as many as light is averaged over
};

/// How many virtual lights there are, of so many that may be.
std::string lightsText(const FrameStats& stats, const Settings& settings) {
  const SourceRow& source = rowOf(settings.vpl.source);
  if (source.tree) return "lights in trees";
  const std::string of = source.sampled ? " of " + std::to_string(settings.smc.vpls) : "";
  return std::to_string(stats.vplsAlive) + of + " virtual lights";
}

void render(const RenderOptions& options) {
  const Buffer buffer = bufferByName(options.buffer);
  const std::string out = options.output.out.empty() ? "lambent.png" : options.output.out;
  checkPictureName(out);
  const auto stage = openStage(options.launch);
  say(*stage, options.output.quiet);
  GlContext context = GlContext::headless();
  GiFrame gi(stage->settings, stage->seed);
  Progress progress("placing virtual lights", options.output.quiet);
  const FrameStats* stats = nullptr;
  int frames = std::max(1, options.frames);
  for (int i = 0; i < frames; ++i) {
    stats = &gi.run(stage->at(0), [&](int done, int total) { progress.update(done, total); });
    sayWarning(*stats);
    if (options.frames == 0 && stats->plan.on(EffectId::History)) frames = stage->settings.history.frames;
  }
  writeBuffer(out, gi, buffer);
  nlohmann::json figures = figuresOf(*stats);
  figures["exposure"] = gi.exposure();
  figures["picture"] = out;
  writeJson(options.output.json, figures);
  if (!options.output.quiet)
    std::printf("%s: %dx%d, %s, exposure %.3g, last frame %.0f ms\n", out.c_str(), stage->camera.width,
                stage->camera.height, lightsText(*stats, stage->settings).c_str(), double(gi.exposure()),
                stats->wallMs);
}

} // namespace

void declareRender(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = app.add_subcommand("render", "one view of a scene as a picture");
  command->add_option("SCENE", options->launch.scene, "glTF or shot file")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output, "picture, .png or linear .exr (default lambent.png)");
  command->add_option("--buffer", options->buffer,
                      "beauty, direct, indirect, irradiance, albedo, normal, depth, or a debug view");
  command
      ->add_option("--frames", options->frames,
                   "frames up to the picture (default: as many as its light is averaged over, history.frames)")
      ->check(CLI::Range(1, 1000000));
  command->callback([options] { render(*options); });
}

} // namespace lambent
