// lambent reference SCENE|SHOT: path-traced truth, progressive and resumable. lambent compare A B: RMSE, relative MSE,
// bias and largest difference of two linear pictures.
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/progress.h"
#include "gi/measure/image_error.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/picture.h"
#include "tools/lambent/study.h"

#include <chrono>
#include <cstdio>
#include <sstream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

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

ReferenceBuffer referenceBufferByName(const std::string& name) {
  const std::vector<std::string> names = {"beauty", "direct", "indirect", "irradiance"};
  if (const auto found = std::ranges::find(names, name); found != names.end())
    return ReferenceBuffer(found - names.begin());
  throw InputError("--buffer " + name, "no such buffer of the reference (" +
                                           guessText(name, names, "beauty, direct, indirect, irradiance") + ")");
}

void checkClamp(const ReferenceOptions& options, const Settings& settings) {
  if (options.clamped && settings.gather.clamp <= 0)
    throw InputError("--clamped", "there is no clamp (give one, in 1/m^2: --set gather.clamp=10)");
}

/// Indirect radiance at the tracked pixels of every frame of a shot.
void trackPixels(const ReferenceOptions& options) {
  if (fs::path(options.pixels).extension() != ".csv") throw InputError(options.pixels, "not a table (.csv)");
  checkWritable(options.pixels);
  LaunchOptions launch = options.launch;
  launch.set.insert(launch.set.begin(), kLambertReceivers);
  const auto opened = openAndSay(launch, options.output.quiet);
  if (!opened->shot) throw InputError(options.launch.scene, "not a shot (a .json file; --pixels follows its frames)");
  const Settings& settings = opened->settings;
  checkClamp(options, settings);
  refuseGlossy(settings);
  const TrackedPixels tracked = trackedPixels(*opened->shot, options.grid);
  const uint32_t samples = uint32_t(options.samples.value_or(kDefaultSamples));
  WatchedScene watched(tracked.points);
  RunPlan plan = planOf(*opened, 0);
  constexpr size_t kMost = 10'000'000; // values, which are kept: 0.5 GB
  if (!launch.trust.large && tracked.points.size() * size_t(plan.frames) > kMost)
    throw InputError(launch.scene, "asks for " + std::to_string(tracked.points.size()) + " pixels in " +
                                       std::to_string(plan.frames) + " frames (" + std::to_string(kMost) +
                                       " values at most, or --allow-large)");
  plan.view = watchedBy(watched, plan.view);
  plan.points = tracked.points;
  const auto series = run({{"truth", settings, opened->seed, pathsAtPoints(watched, samples, options.clamped)}}, plan,
                          "tracing paths", options.output.quiet)[0]
                          .series;
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
  writeText(options.pixels, "frame,pixel,marked,u,v,surface,r,g,b,error_r,error_g,error_b\n" + rows.str());
  if (!options.output.quiet)
    std::printf("%s: indirect radiance at %zu pixels (%zu marked) in %zu frames, %u samples each\n",
                options.pixels.c_str(), tracked.points.size(), tracked.marked, series.size(), samples);
}

void reference(const ReferenceOptions& options) {
  if (!options.pixels.empty()) return trackPixels(options);
  const ReferenceBuffer buffer = referenceBufferByName(options.buffer);
  const std::string& out = options.output.out;
  checkPictureName(out);
  if (!options.errors.empty()) checkPictureName(options.errors);
  if (!options.state.empty()) {
    checkWritable(options.state);
    removeLeftovers(options.state);
  }
  const auto opened = openAndSay(options.launch, options.output.quiet, WatchUntil::FirstPicture);
  const Settings& settings = opened->settings;
  checkClamp(options, settings);
  const auto begin = std::chrono::steady_clock::now();
  const TracedImage traced = trace(opened->at(options.time), settings,
                                   {.buffer = buffer,
                                    .samples = uint32_t(options.samples.value_or(
                                        options.error > 0 ? int(ReferenceSums::kMostSamples) : kDefaultSamples)),
                                    .error = options.error,
                                    .clamped = options.clamped,
                                    .seed = opened->seed,
                                    .state = options.state},
                                   "tracing paths", options.output.quiet);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  if (traced.samples > 0) {
    const ReferenceImage& picture = traced.image;
    const float factor = buffer == ReferenceBuffer::Irradiance ? traced.exposure / kPi : traced.exposure;
    writePicture(out, picture.mean, factor, settings.image.toneMapper);
    if (!options.errors.empty()) writePicture(options.errors, picture.error, factor);
    writeJson(options.output.json,
              Value::of("picture", out, "buffer", options.buffer, "bounces", traced.bounces, "clamp", traced.clamp,
                        "spp", traced.samples, "relative_error", picture.relativeError, "relative_error_of_mean",
                        picture.relativeErrorOfMean, "exposure", traced.exposure, "seconds", seconds, "rays",
                        Value::of("closest", traced.rays.closest, "occlusion", traced.rays.occlusion)));
    if (!options.output.quiet)
      std::printf("%s: %dx%d %s, %d bounces, %u samples per pixel, standard error %.3g %% per pixel (RMS over mean), "
                  "%.2g %% of the mean, %.1f s\n",
                  out.c_str(), picture.mean.width, picture.mean.height, options.buffer.c_str(), traced.bounces,
                  traced.samples, 100 * picture.relativeError, 100 * picture.relativeErrorOfMean, seconds);
  }
  if (interrupted && traced.samples == 0) throw RunError("interrupted before there was a sample: nothing is written");
  if (interrupted)
    throw RunError("interrupted: " + std::to_string(traced.samples) + " samples per pixel are kept" +
                   (options.state.empty() ? " in the picture" : "; the same command goes on"));
}

struct CompareOptions {
  OutputOptions output;
  std::string a, b, layer, mask, difference;
};

std::string sizeText(const Image& image) { return std::to_string(image.width) + "x" + std::to_string(image.height); }

void checkSize(const std::string& file, const Image& image, const std::string& like, const Image& wanted) {
  if (image.width != wanted.width || image.height != wanted.height)
    throw InputError(file, sizeText(image) + ", while " + like + " is " + sizeText(wanted) + " (sizes must agree)");
}

void compare(const CompareOptions& options) {
  if (!options.difference.empty()) checkPictureName(options.difference);
  const Image x = readLinear(options.a);
  const Image y = readLinear(options.b, options.layer);
  checkSize(options.b, y, options.a, x);
  Image mask;
  if (!options.mask.empty()) {
    mask = readLinear(options.mask);
    checkSize(options.mask, mask, options.a, x);
  }
  const ImageError e = imageError(x, y, mask);
  if (e.pixels == 0 && e.notFinite == 0) throw InputError(options.mask, "leaves no pixel (those above 0 count)");
  if (!options.difference.empty()) {
    Image difference = absoluteDifference(x, y);
    for (size_t i = 0; i < mask.pixels.size(); ++i)
      if (!(maxComponent(mask.pixels[i]) > 0)) difference.pixels[i] = vec3(0);
    writePicture(options.difference, difference, midGreyAt(e.meanTruth));
  }
  writeJson(options.output.json,
            Value::of("rmse", e.rmse, "rel_mse", e.relMse, "bias", e.bias, "max", e.largest, "mean_b", e.meanTruth,
                      "pixels", e.pixels, "not_finite_pixels", e.notFinite));
  const auto refuse = [&] { // figures of the others are right, but this is no picture to be content with
    if (e.notFinite == 0) return;
    const auto finite = [](const Image& image) {
      return std::ranges::all_of(image.pixels, [](const vec3& p) { return isFinite(p); });
    };
    throw RunError((finite(x)   ? options.b
                    : finite(y) ? options.a
                                : options.a + " and " + options.b) +
                   ": " + std::to_string(e.notFinite) + " pixels are NaN or infinite (--mask leaves them out)");
  };
  if (options.output.quiet || e.pixels == 0) return refuse();
  std::printf("RMSE    %.6g\nrelMSE  %.6g\n", e.rmse, e.relMse);
  if (e.meanTruth == 0 && e.rmse > 0)
    std::printf("bias    none, for B is black\n");
  else
    std::printf("bias    %+.3f %%   mean(A-B)/mean(B)\n", 100 * e.bias);
  std::printf("max     %.6g\nmean B  %.6g\n", e.largest, e.meanTruth);
  if (e.notFinite > 0) std::printf("%zu pixels with NaN or infinity left out\n", e.notFinite);
  refuse();
}

} // namespace

void declareReference(CLI::App& app) {
  auto options = std::make_shared<ReferenceOptions>();
  Command command(app, "reference", "path-traced truth of one view; can be continued");
  command.reads("SCENE", options->launch.scene, "glTF or shot file", true);
  command.launch(options->launch);
  command.output(options->output, "picture, linear .exr or .png (default reference.exr)", "reference.exr");
  command.text("--buffer", options->buffer, "beauty, direct, indirect or irradiance");
  command.number("--spp", &options->samples, 1, int(ReferenceSums::kMostSamples),
                 "samples per pixel in all (default 64; with --error no bound)");
  command.number("--error", &options->error, 1e-6, 1e6,
                 "stop at this standard error per pixel: its RMS over pixels and channels, over the picture's mean");
  command.number("--time", &options->time, 0, 0, "seconds into the shot or the scene's animation");
  command.writes("--state", options->state, "keep the sums in this file, and go on from it when it is there");
  command.writes("--errors", options->errors, "write the standard error of each pixel (.exr or .png)");
  command.writes("--pixels", options->pixels,
                 "for a shot: write indirect radiance at its marked pixels and a grid, all frames (.csv)");
  command.number("--grid", &options->grid, 0, 256, "grid of so many by so many pixels (default 16)");
  command.flag("--clamped", options->clamped,
               "bound the geometry term between picture and first bounce as gather.clamp bounds virtual lights");
  command.run([options] { reference(*options); });
}

void declareCompare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  Command command(app, "compare", "errors of picture A against B (linear .exr or .pfm)");
  command.reads("A", options->a, "picture to judge", true);
  command.reads("B", options->b, "picture to hold it to", true);
  command.text("--layer", options->layer, "layer of B to take, where it is an .exr with several");
  command.reads("--mask", options->mask, "compare only pixels where this picture (.exr or .pfm) is above 0");
  command.writes("--difference", options->difference, "write |A-B|, linear .exr or .png (mean of B is mid grey)");
  command.output(options->output, "");
  command.run([options] { compare(*options); });
}

} // namespace lambent
