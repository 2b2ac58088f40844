// lambent reference SCENE|SHOT: path-traced truth, progressive and resumable.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/core/text.h"
#include "gi/measure/runs/runs.h"
#include "gi/reference/traced_picture.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/linear_picture.h"

#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace lambent {

namespace {

namespace fs = std::filesystem;

struct ReferenceOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::string buffer = "beauty", state, errors, pixels;
  int grid = 16;
  std::optional<int> samples;
  double error = 0, time = 0;
  bool clamped = false;
};

constexpr int kDefaultSamples = 64;
constexpr int kLargestSamples = 1 << 24;

ReferenceBuffer referenceBufferByName(const std::string& name) {
  const std::vector<std::string> names = {"beauty", "direct", "indirect", "irradiance"};
  for (size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return ReferenceBuffer(i);
  const std::string near = nearestName(name, names);
  throw InputError("--buffer " + name,
                   "no such buffer of the reference (" +
                       (near.empty() ? "beauty, direct, indirect, irradiance" : "did you mean " + near + "?") + ")");
}

void checkClamp(const ReferenceOptions& options, const Settings& settings) {
  if (options.clamped && settings.gather.clamp <= 0)
    throw InputError("--clamped", "there is no clamp (give one, in 1/m^2: --set gather.clamp=10)");
}

/// Indirect radiance at the tracked pixels of every frame of a shot.
void trackPixels(const ReferenceOptions& options) {
  if (fs::path(options.pixels).extension() != ".csv") throw InputError(options.pixels, "not a table (.csv)");
  checkWritable(options.pixels);
  const auto stage = openLaunch(options.launch);
  say(*stage, options.output.quiet);
  if (!stage->shot) throw InputError(options.launch.scene, "not a shot (a .json file; --pixels follows its frames)");
  const Settings& settings = stage->settings;
  checkClamp(options, settings);
  refuseGlossy(settings);
  const TrackedPixels tracked = trackedPixels(*stage->shot, options.grid);
  const uint32_t samples = uint32_t(options.samples.value_or(kDefaultSamples));
  WatchedScene watched(tracked.points);
  std::vector<std::vector<TrackedValue>> series;
  {
    Progress progress("tracing paths", options.output.quiet);
    RunPlan plan = planOf(*stage, progress, 0);
    plan.view = [&, shown = plan.view](int frame) {
      const SceneView view = shown(frame);
      watched.update(view);
      return view;
    };
    plan.points = tracked.points;
    series =
        measure({{"truth", settings, stage->seed, pathsAtPoints(watched, samples, options.clamped)}}, plan)[0].series;
  }
  std::ostringstream rows;
  for (size_t f = 0; f < series.size(); ++f)
    for (size_t i = 0; i < series[f].size(); ++i) {
      const TrackedValue& v = series[f][i];
      rows << f << ',' << i << ',' << (i < tracked.marked) << ',' << tracked.points[i].x << ',' << tracked.points[i].y
           << ',' << watched.seen()[f][i];
      for (const vec3& value : {v.radiance, v.error})
        for (int c = 0; c < 3; ++c) rows << ',' << value[c];
      rows << '\n';
    }
  writeAtomically(options.pixels, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << "frame,pixel,marked,u,v,surface,r,g,b,error_r,error_g,error_b\n" << rows.str();
    if (!out.flush()) throw RunError(options.pixels + ": cannot be written");
  });
  if (!options.output.quiet)
    std::printf("%s: indirect radiance at %zu pixels (%zu marked) in %zu frames, %u samples each\n",
                options.pixels.c_str(), tracked.points.size(), tracked.marked, series.size(), samples);
}

void reference(const ReferenceOptions& options) {
  if (!options.pixels.empty()) return trackPixels(options);
  const ReferenceBuffer buffer = referenceBufferByName(options.buffer);
  const std::string out = options.output.out.empty() ? "reference.exr" : options.output.out;
  checkPictureName(out);
  if (!options.errors.empty()) checkPictureName(options.errors);
  if (!options.state.empty()) {
    checkWritable(options.state);
    removeLeftovers(options.state);
  }
  const auto stage = openLaunch(options.launch);
  say(*stage, options.output.quiet);
  const Settings& settings = stage->settings;
  checkClamp(options, settings);
  const auto begin = std::chrono::steady_clock::now();
  TracedPicture traced;
  {
    Progress progress("tracing paths", options.output.quiet);
    traced = tracePicture(
        stage->at(options.time), settings,
        {.buffer = buffer,
         .samples = uint32_t(options.samples.value_or(options.error > 0 ? kLargestSamples : kDefaultSamples)),
         .error = options.error,
         .clamped = options.clamped,
         .seed = stage->seed,
         .state = options.state,
         .cancelled = [] { return interrupted.load(); },
         .progress = [&](int done, int total) { progress.update(done, total); }});
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  if (traced.samples > 0) {
    const ReferencePicture& picture = traced.picture;
    const float factor = buffer == ReferenceBuffer::Irradiance ? traced.exposure / kPi : traced.exposure;
    writePicture(out, picture.mean, factor, settings.image.toneMapper);
    if (!options.errors.empty()) writePicture(options.errors, picture.error, factor);
    writeJson(options.output.json,
              {{"picture", out},
               {"buffer", options.buffer},
               {"bounces", traced.bounces},
               {"clamp", traced.clamp},
               {"spp", traced.samples},
               {"relative_error", picture.relativeError},
               {"relative_error_of_mean", picture.relativeErrorOfMean},
               {"exposure", traced.exposure},
               {"seconds", seconds},
               {"rays", {{"closest", traced.rays.closest}, {"occlusion", traced.rays.occlusion}}}});
    if (!options.output.quiet)
      std::printf("%s: %dx%d %s, %d bounces, %u samples per pixel, standard error %.3g %% per pixel (RMS over mean), "
                  "%.2g %% of the mean, %.1f s\n",
                  out.c_str(), picture.mean.width, picture.mean.height, options.buffer.c_str(), traced.bounces,
                  traced.samples, 100 * picture.relativeError, 100 * picture.relativeErrorOfMean, seconds);
  }
  if (interrupted)
    throw RunError("interrupted: " + std::to_string(traced.samples) + " samples per pixel are kept" +
                   (options.state.empty() ? " in the picture" : "; the same command goes on"));
}

} // namespace

void declareReference(CLI::App& app) {
  auto options = std::make_shared<ReferenceOptions>();
  CLI::App* command = app.add_subcommand("reference", "path-traced truth of one view; can be continued");
  command->add_option("SCENE", options->launch.scene, "glTF or shot file")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output, "picture, linear .exr or .png (default reference.exr)");
  command->add_option("--buffer", options->buffer, "beauty, direct, indirect or irradiance");
  command->add_option("--spp", options->samples, "samples per pixel in all (default 64; with --error no bound)")
      ->check(CLI::Range(1, kLargestSamples));
  command
      ->add_option("--error", options->error,
                   "stop at this standard error per pixel: its RMS over pixels and channels, over the picture's mean")
      ->check(CLI::Range(1e-6, 1e6));
  command->add_option("--time", options->time, "seconds into the shot or the scene's animation");
  command->add_option("--state", options->state, "keep the sums in this file, and go on from it when it is there");
  command->add_option("--errors", options->errors, "write the standard error of each pixel (.exr or .png)");
  command->add_option("--pixels", options->pixels,
                      "for a shot: write indirect radiance at its marked pixels and a grid, all frames (.csv)");
  command->add_option("--grid", options->grid, "grid of so many by so many pixels (default 16)")
      ->check(CLI::Range(0, 256));
  command->add_flag("--clamped", options->clamped,
                    "bound the geometry term between picture and first bounce as gather.clamp bounds virtual lights");
  command->callback([options] { reference(*options); });
}

} // namespace lambent
