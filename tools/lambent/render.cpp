// lambent render SCENE: one view → image.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "tools/lambent/commands.h"

#include <chrono>
#include <cstdio>

namespace lambent {

namespace {

struct RenderOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::string buffer = "beauty";
  int frames = 0; // as many as light is averaged over
};

/// What brought the indirect light of a frame that was drawn.
std::string lightsText(const FrameStats& stats, const Settings& settings) {
  if (!stats.plan.on(EffectId::Indirect)) return "direct light only";
  const Needs needs = needsOf(settings);
  if (needs.tree) return "virtual lights in trees";
  if (needs.lights == LightSupply::None) return "no virtual lights";
  const std::string count = std::to_string(stats.vplsAlive);
  if (needs.lights == LightSupply::Fixed) return count + " samples of surfaces";
  return count + (needs.sampled() ? " of " + std::to_string(settings.smc.vpls) : "") + " virtual lights";
}

void render(const RenderOptions& options) {
  const Buffer buffer = bufferByName(options.buffer);
  const std::string out = options.output.out.empty() ? "lambent.png" : options.output.out;
  checkPictureName(out);
  const auto stage = openLaunch(options.launch);
  say(*stage, options.output.quiet);
  GlContext context = GlContext::headless();
  Viewer gi(stage->settings, stage->seed);
  Progress progress("placing virtual lights", options.output.quiet);
  const auto begin = std::chrono::steady_clock::now();
  const FrameStats* stats = nullptr;
  FrameStats drawn; // of the last frame that was: once the lights have settled the picture stays
  int frames = std::max(1, options.frames);
  for (int i = 0; i < frames; ++i) {
    stats = &gi.run(stage->at(0), [&](int done, int total) {
      progress.update(done, total);
      if (interrupted) throw RunError("interrupted");
    });
    sayWarning(*stats);
    if (stats->plan.on(EffectId::Redraw)) drawn = *stats;
    if (options.frames == 0 && stats->plan.on(EffectId::History)) frames = stage->settings.history.frames;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  writeBuffer(out, gi, buffer);
  nlohmann::json figures = figuresOf(*stats);
  figures["exposure"] = gi.exposure();
  figures["picture"] = out;
  writeJson(options.output.json, figures);
  if (!options.output.quiet)
    std::printf("%s: %dx%d, %s, exposure %.3g, %d frame%s in %.1f s (the last drawn took %.1f ms)\n", out.c_str(),
                stage->camera.width, stage->camera.height, lightsText(drawn, stage->settings).c_str(),
                double(gi.exposure()), frames, frames == 1 ? "" : "s", took.count(), drawn.wallMs);
}

} // namespace

void declareRender(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = app.add_subcommand("render", "one view of a scene as a picture");
  command->add_option("SCENE", options->launch.scene, "glTF or shot file")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output, "picture, .png or linear .exr (default lambent.png)");
  addBufferOption(*command, options->buffer, "draw");
  command
      ->add_option("--frames", options->frames,
                   "frames up to the picture (default: as many as its light is averaged over, history.frames)")
      ->check(CLI::Range(1, 1000000));
  command->callback([options] { render(*options); });
}

} // namespace lambent
