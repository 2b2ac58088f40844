// lambent reference SCENE|SHOT: path-traced truth, progressive and resumable.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/core/text.h"
#include "engine/trace/embree_query.h"
#include "gi/vpl/smc.h"
#include "gi/reference/state_file.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/tracked_pixels.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace lambent {

namespace {

using Clock = std::chrono::steady_clock;
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
// Fewer samples do not tell their own error.
constexpr uint32_t kSamplesToJudge = 16;

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

/// As GiFrame measures it: log-average luminance of the visible surfaces to 0.18.
float measuredExposure(const ReferencePicture& beauty) {
  double logSum = 0;
  size_t count = 0;
  for (size_t i = 0; i < beauty.surface.size(); ++i) {
    const float y = luminance(beauty.mean.pixels[i]);
    if (!beauty.surface[i] || !(y > 0) || !std::isfinite(y)) continue;
    logSum += std::log(double(y));
    ++count;
  }
  return count == 0 ? 1.0f : float(0.18 / std::exp(logSum / double(count)));
}

/// Samples until enough are taken, the error is reached or Ctrl-C; saves the state as it goes.
class Run {
 public:
  Run(const ReferenceOptions& options, const ReferenceInputs& in, ReferenceBuffer buffer, uint64_t key)
      : options_(options), in_(in), buffer_(buffer), key_(key), sums_(in.camera.width, in.camera.height) {
    const bool resumes = !options.state.empty() && std::filesystem::exists(options.state);
    if (resumes) sums_ = loadReference(options.state, in, key);
    saved_ = sums_.samples;
    wanted_ = uint32_t(options.samples.value_or(options.error > 0 ? kLargestSamples : kDefaultSamples));
  }

  void sample() {
    // A pass takes about a second: the bar moves, and Ctrl-C is heard.
    const size_t perPass = std::clamp<size_t>((1 << 19) / sums_.pixels.size(), 1, 64);
    Progress progress("tracing paths", options_.output.quiet);
    auto lastSave = Clock::now();
    while (!interrupted && sums_.samples < wanted_) {
      const double error = options_.error > 0 && sums_.samples >= kSamplesToJudge
                               ? readReference(sums_, in_, buffer_).relativeError
                               : double(kInfinity);
      if (error <= options_.error) break;
      addSamples(sums_, in_, std::min<uint32_t>(uint32_t(perPass), wanted_ - sums_.samples), counts_);
      progress.update(int(sums_.samples), samplesExpected(error));
      if (!options_.state.empty() && Clock::now() - lastSave > std::chrono::seconds(60)) {
        save();
        lastSave = Clock::now();
      }
    }
    save();
  }

  const ReferenceSums& sums() const { return sums_; }
  const RayCounts& counts() const { return counts_; }

 private:
  /// Error falls with the root of the number of samples.
  int samplesExpected(double error) const {
    const double forError = std::isfinite(error) ? sums_.samples * std::pow(error / options_.error, 2) : 1e9;
    return int(std::max<double>(sums_.samples, std::min<double>(wanted_, forError)));
  }

  void save() {
    if (options_.state.empty() || saved_ == sums_.samples) return;
    saveReference(options_.state, sums_, key_);
    saved_ = sums_.samples;
  }

  const ReferenceOptions& options_;
  const ReferenceInputs& in_;
  const ReferenceBuffer buffer_;
  const uint64_t key_;
  ReferenceSums sums_;
  RayCounts counts_;
  uint32_t wanted_ = 0, saved_ = 0;
};

/// Indirect radiance at the tracked pixels of every frame of a shot.
void trackPixels(const ReferenceOptions& options) {
  if (fs::path(options.pixels).extension() != ".csv") throw InputError(options.pixels, "not a table (.csv)");
  const auto stage = openStage(options.launch);
  say(*stage, options.output.quiet);
  if (!stage->shot) throw InputError(options.launch.scene, "not a shot (a .json file; --pixels follows its frames)");
  const Settings& settings = stage->settings;
  checkClamp(options, settings);
  refuseGlossy(settings);
  const TrackedPixels tracked = trackedPixels(*stage->shot, options.grid);
  const uint32_t samples = uint32_t(options.samples.value_or(kDefaultSamples));
  std::unique_ptr<EmbreeQuery> rays;
  std::ostringstream rows;
  const int total = stage->shot->frameCount();
  int done = 0;
  {
    Progress progress("tracing paths", options.output.quiet);
    for (; done < total && !interrupted; progress.update(++done, total)) {
      const SceneView view = stage->at(done / stage->shot->fps);
      if (!rays) rays = std::make_unique<EmbreeQuery>(*view.assets);
      rays->update(view);
      const LightSet lights = collectLights(view);
      const std::vector<SurfaceHit> surfaces = surfacesAt(*rays, view.camera, tracked.points);
      RayCounts counts;
      const std::vector<PixelSums> sums = sampleSurfaces(
          surfaces,
          {*rays, lights, view.camera, settings.smc.bounces, options.clamped ? settings.gather.clamp : 0, stage->seed},
          samples, counts);
      for (size_t i = 0; i < sums.size(); ++i) {
        const TrackedValue v = trackedValue(sums[i], surfaces[i], samples);
        rows << done << ',' << i << ',' << (i < tracked.marked) << ',' << tracked.points[i].x << ','
             << tracked.points[i].y << ',' << surfaces[i].valid();
        for (int c = 0; c < 3; ++c) rows << ',' << v.radiance[c];
        for (int c = 0; c < 3; ++c) rows << ',' << v.error[c];
        rows << '\n';
      }
    }
  }
  writeAtomically(options.pixels, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << "frame,pixel,marked,u,v,surface,r,g,b,error_r,error_g,error_b\n" << rows.str();
    if (!out.flush()) throw RunError(options.pixels + ": cannot be written");
  });
  if (!options.output.quiet)
    std::printf("%s: indirect radiance at %zu pixels (%zu marked) in %d frames, %u samples each\n",
                options.pixels.c_str(), tracked.points.size(), tracked.marked, done, samples);
  if (interrupted) throw RunError("interrupted: " + std::to_string(done) + " frames are written");
}

void reference(const ReferenceOptions& options) {
  if (!options.pixels.empty()) return trackPixels(options);
  const ReferenceBuffer buffer = referenceBufferByName(options.buffer);
  const std::string out = options.output.out.empty() ? "reference.exr" : options.output.out;
  checkPictureName(out);
  if (!options.errors.empty()) checkPictureName(options.errors);
  const auto stage = openStage(options.launch);
  say(*stage, options.output.quiet);
  const Settings& settings = stage->settings;
  checkClamp(options, settings);
  const SceneView view = stage->at(options.time);
  EmbreeQuery rays(*view.assets);
  rays.update(view);
  const LightSet lights = collectLights(view);
  const ReferenceInputs in{.rays = rays,
                           .lights = lights,
                           .camera = view.camera,
                           .bounces = settings.smc.bounces,
                           .clamp = options.clamped ? settings.gather.clamp : 0,
                           .seed = stage->seed,
                           // Irradiance does not depend on how it is reflected.
                           .glossy = settings.gather.glossy && settings.effects[EffectId::Glossy] != EffectMode::Off &&
                                             buffer != ReferenceBuffer::Irradiance
                                         ? &view
                                         : nullptr};

  const auto begin = Clock::now();
  Run run(options, in, buffer, referenceKey(view, in));
  run.sample();
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();

  const ReferenceSums& sums = run.sums();
  if (sums.samples > 0) {
    const ReferencePicture picture = readReference(sums, in, buffer);
    const bool measure = settings.image.exposure <= 0;
    const float exposure =
        measure ? measuredExposure(readReference(sums, in, ReferenceBuffer::Beauty)) : settings.image.exposure;
    const float factor = buffer == ReferenceBuffer::Irradiance ? exposure / kPi : exposure;
    writePicture(out, picture.mean, factor);
    if (!options.errors.empty()) writePicture(options.errors, picture.error, factor);
    writeJson(options.output.json,
              {{"picture", out},
               {"buffer", options.buffer},
               {"bounces", in.bounces},
               {"clamp", in.clamp},
               {"spp", sums.samples},
               {"relative_error", picture.relativeError},
               {"relative_error_of_mean", picture.relativeErrorOfMean},
               {"exposure", exposure},
               {"seconds", seconds},
               {"rays", {{"closest", run.counts().closest}, {"occlusion", run.counts().occlusion}}}});
    if (!options.output.quiet)
      std::printf("%s: %dx%d %s, %d bounces, %u samples per pixel, standard error %.3g %% per pixel (RMS over mean), "
                  "%.2g %% of the mean, %.1f s\n",
                  out.c_str(), sums.width, sums.height, options.buffer.c_str(), in.bounces, sums.samples,
                  100 * picture.relativeError, 100 * picture.relativeErrorOfMean, seconds);
  }
  if (interrupted)
    throw RunError("interrupted: " + std::to_string(sums.samples) + " samples per pixel are kept" +
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
