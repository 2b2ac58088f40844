// lambent render SCENE: one view → image.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/picture.h"

#include <chrono>
#include <cstdio>

namespace lambent {

namespace {

struct RenderOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::string buffer = "beauty";
  std::optional<int> frames; // none: as many as light is averaged over
};

/// What brought the indirect light of a frame that was drawn.
std::string lightsText(const FrameStats& stats, const Settings& settings) {
  if (!stats.plan.on(EffectId::Indirect)) return "direct light only";
  const SourceRow& source = rowOf(settings.vpl.source);
  if (source.tree) return "virtual lights in trees";
  if (settings.vpl.source == VplSource::None) return "no virtual lights";
  const std::string count = std::to_string(stats.vplsAlive);
  if (source.fixed) return count + " samples of surfaces";
  return count + (source.sampled ? " of " + std::to_string(settings.smc.vpls) : "") + " virtual lights";
}

void render(const RenderOptions& options) {
  const Buffer buffer = bufferByName(options.buffer);
  const std::string out = options.output.out.empty() ? "lambent.png" : options.output.out;
  checkPictureName(out);
  const auto opened = openAndSay(options.launch, options.output.quiet);
  GlContext context = GlContext::headless();
  GiFrame gi(opened->settings, opened->seed);
  Progress progress("placing virtual lights", options.output.quiet);
  const auto begin = std::chrono::steady_clock::now();
  const FrameStats* stats = nullptr;
  FrameStats drawn; // of the last frame that was: once the lights have settled the picture stays
  int frames = options.frames.value_or(1);
  for (int i = 0; i < frames; ++i) {
    stats = &gi.run(opened->at(0), [&](int done, int total) {
      progress.update(done, total);
      if (interrupted) throw RunError("interrupted");
    });
    sayWarning(*stats);
    if (stats->plan.on(EffectId::Redraw)) drawn = *stats;
    if (!options.frames && stats->plan.on(EffectId::History)) frames = opened->settings.history.frames;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  writeBuffer(out, gi, buffer);
  Value figures = figuresOf(*stats);
  figures["exposure"] = gi.exposure();
  figures["picture"] = out;
  writeJson(options.output.json, figures);
  if (!options.output.quiet)
    std::printf("%s: %dx%d, %s, exposure %.3g, %d frame%s in %.1f s (the last drawn took %.1f ms)\n", out.c_str(),
                opened->camera.width, opened->camera.height, lightsText(drawn, opened->settings).c_str(),
                double(gi.exposure()), frames, frames == 1 ? "" : "s", took.count(), drawn.wallMs);
}

} // namespace

void declareRender(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  Command command(app, "render", "one view of a scene as a picture");
  command.scene(options->launch.scene, "SCENE", "glTF or shot file");
  command.launch(options->launch);
  command.output(options->output, "picture, .png or linear .exr (default lambent.png)");
  command.text("--buffer", options->buffer, bufferHelp(options->buffer, "draw"));
  command.number("--frames", options->frames, 1, 1000000,
                 "frames up to the picture (default: as many as its light is averaged over, history.frames)");
  command.run([options] { render(*options); });
}

} // namespace lambent
