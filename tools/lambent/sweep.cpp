#include "tools/lambent/sweep.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/progress.h"
#include "engine/image/exposure.h"
#include "gi/measure/stability.h"
#include "gi/plan/techniques.h"
#include "tools/kept/run_log.h"

#include <algorithm>
#include <fstream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kGoesOn = "interrupted: the same command goes on";
constexpr int kGrid = 16;            // watched pixels besides the shot's own, squared
constexpr int kBetweenControls = 10; // runs
constexpr int kControlSeeds = 4;     // of the default: what chance does to an error

class SceneSweep {
 public:
  SceneSweep(const AccuracyOptions& options, const std::string& file, const fs::path& folder, const SweepFrames& frames)
      : options_(options), frames_(frames), folder_(folder),
        study_(options, file, {.size = "128x72", .quickSize = "48x27", .set = {{"gather.glossy", "off"}}}),
        opened_(*study_.opened), name_(nameOf(file)), samples_(options.samples.value_or(options.quick ? 64 : 2048)) {
    refuseGlossy(opened_.settings);
    punctual_ = std::ranges::any_of(opened_.at(0).lights,
                                    [](const LightView& light) { return maxComponent(light.intensity) > 0; });
    out_.name = name_;
    conditions_ = conditionsOf(
        opened_, study_.launch,
        format("%d %d %d %d %d", samples_, frames_.moving, frames_.still, frames_.slow, study_.launch.threads));
    out_.pictures = folder_ / ("pictures-" + name_ + "-" + conditions_); // not beside another program's
    makeFolder(out_.pictures);
    replaceOnlyOwnIn(out_.pictures);
    for (const std::string& name : {std::string("index.html"), std::string("points.csv"), "runs-" + name_ + ".jsonl"})
      checkWritable(folder_ / name); // before the work, when what the scene reads is known
  }

  SweptScene run() {
    traceTruths();
    RunLog log(folder_ / ("runs-" + name_ + ".jsonl"), conditions_);
    std::vector<SweepPoint> points;
    for (SweepPoint& p : sweepPoints(options_.sweepPart())) {
      if (!p.technique.empty() && needsOf(techniqueByName(p.technique)).reflective() && !punctual_)
        out_.leftOut.push_back(p.technique + ": no punctual light to draw reflective maps from");
      else
        points.push_back(std::move(p));
    }
    // With one seed noise is the default's alone, which the controls show.
    std::vector<std::pair<const SweepPoint*, int>> runs; // point and seed
    for (int seed = 0; seed < options_.seeds.value_or(1); ++seed)
      for (const SweepPoint& p : points) runs.emplace_back(&p, seed);
    Progress progress(name_, options_.output.quiet);
    int done = 0, control = 0, sinceControl = kBetweenControls;
    for (const auto& [point, seed] : runs) {
      progress.update(done++, int(runs.size()));
      const std::string key = point->name + format(" seed %d", seed);
      if (log.has(key)) continue;
      if (sinceControl++ >= kBetweenControls) addControl(log, points[0], control), sinceControl = 1;
      log.add(key, measured(*point, seed, key));
    }
    while (!options_.quick && controls(log) < kControlSeeds) addControl(log, points[0], control);
    progress.update(1, 1);
    out_.runs = log.runs();
    return std::move(out_);
  }

 private:
  static size_t controls(const RunLog& log) {
    return size_t(std::ranges::count_if(log.runs(), [](const Value& run) { return run.has("control"); }));
  }

  void addControl(RunLog& log, const SweepPoint& standard, int& control) {
    std::string key;
    do key = format("control %d", control++);
    while (log.has(key));
    Value run = measured(standard, (control - 1) % kControlSeeds, key);
    run["control"] = true;
    log.add(key, std::move(run));
  }

  SceneView viewAt(int frame) {
    const double fps = opened_.shot ? opened_.shot->fps : 30;
    return opened_.at(std::min(frame, frames_.moving - 1) / fps);
  }

  void traceTruths() {
    for (KnobLight light : {KnobLight::Indirect, KnobLight::Direct}) {
      const bool indirect = light == KnobLight::Indirect;
      const std::string name = indirect ? "indirect" : "direct",
                        file = "truth-" + name_ + "-" + name + "-" + conditions_;
      const fs::path pace = folder_ / (file + ".ms");
      requireFileOrNothing(pace);
      const TracedImage traced = trace(viewAt(frames_.moving - 1), opened_.settings,
                                       {.buffer = indirect ? ReferenceBuffer::Irradiance : ReferenceBuffer::Direct,
                                        .samples = uint32_t(indirect ? samples_ : std::max(samples_ / 8, 2)),
                                        .seed = opened_.seed,
                                        .state = folder_ / (file + ".state")},
                                       name_ + ": truth of " + name + " light", options_.output.quiet);
      if (interrupted) throw RunError(kGoesOn);
      const ReferenceImage& p = traced.image;
      out_.truths[int(light)] = p.mean;
      truthRelMse_[int(light)] = expectedRelMse(p.mean, p.error);
      double sampleMs = 0; // of the pass that took samples; later ones find them all there
      if (traced.sampleSeconds > 0) writeText(pace, format("%.9g", 1000 * traced.sampleSeconds));
      std::ifstream(pace) >> sampleMs;
      out_.truth[name] = Value::of("spp", traced.samples, "relative_error_of_mean", p.relativeErrorOfMean, "rel_mse",
                                   truthRelMse_[int(light)], "seed", opened_.seed, "sample_ms", sampleMs);
    }
    out_.exposure = exposureFor(out_.truths[0].pixels);
  }

  /// Path traced values of the watched pixels, when first needed.
  const PixelSeries& watchedTruth() {
    if (!watchedTruth_.empty()) return watchedTruth_;
    const Shot none;
    tracked_ = trackedPixels(opened_.shot ? *opened_.shot : none, options_.quick ? 4 : kGrid);
    WatchedScene watched(tracked_.points);
    RunPlan plan{.view = watchedBy(watched, [this](int frame) { return viewAt(frame); }),
                 .frames = frames_.moving,
                 .points = tracked_.points};
    const Measured truth =
        lambent::run({{"truth", opened_.settings, opened_.seed, pathsAtPoints(watched, uint32_t(samples_ / 2))}}, plan,
                     name_ + ": truth of watched pixels", options_.output.quiet)[0];
    std::vector<vec3> first;
    for (const TrackedValue& v : truth.series[0]) first.push_back(v.radiance);
    watchedExposure_ = exposureFor(first);
    seen_ = watched.seen();
    return watchedTruth_ = toneMappedSeries(truth.series, seen_, watchedExposure_);
  }

  Value errorsOf(const Image& picture, KnobLight light) const {
    const ImageError e = imageError(picture, out_.truths[int(light)]);
    // What the truth does not know is no error of the picture, down to a tenth of it.
    const double relMse = std::max(e.relMse - truthRelMse_[int(light)], 0.1 * truthRelMse_[int(light)]);
    return Value::of("rel_mse", relMse, "rmse_share", e.rmseShare(), "bias", e.bias);
  }

  Value measured(const SweepPoint& point, int seed, const std::string& key) {
    const bool direct = point.light == KnobLight::Direct;
    Variant variant = study_.variant(point.name, point.set, point.technique);
    variant.seed += uint32_t(seed);
    if (direct) variant.settings.effects[EffectId::Indirect] = EffectMode::Off;
    variant.settings.effects[EffectId::Redraw] = EffectMode::On; // what sleeps would cost nothing
    const PixelSeries& truth = watchedTruth();

    const int moving = point.slow ? std::min(frames_.slow, frames_.moving) : frames_.moving;
    const int still = point.slow || direct ? 0 : frames_.still, skipped = frames_.moving - moving;
    RunPlan plan{.view = [&](int frame) { return viewAt(skipped + frame); },
                 .frames = moving + still,
                 .inTurn = false,
                 .buffer = direct ? Buffer::Direct : Buffer::Irradiance};
    if (still > 0) plan.also = {moving - 1};
    if (!direct) plan.points = tracked_.points;
    Measured m = [&] {
      try {
        return lambent::run({variant}, plan, "", true)[0];
      } catch (const RunError&) {
        if (interrupted) throw RunError(kGoesOn);
        throw;
      }
    }();

    const auto medianMs = [&](int from, int to) {
      std::vector<double> ms;
      for (int f = from; f < to; ++f) ms.push_back(m.frames[size_t(f)].wallMs);
      return spreadOf(std::move(ms)).median;
    };
    Value run = Value::of("point", point.name, "seed", seed, "gpu_mib", double(m.gpuBytes) / (1 << 20));
    run["moving"] = errorsOf(still > 0 ? m.before[0] : m.image, point.light);
    run["moving"]["ms"] = medianMs(std::min(2, moving - 1), moving); // shaders and maps of the first are past
    if (still > 0) {
      run["still"] = errorsOf(m.image, point.light);
      run["still"]["ms"] = medianMs(moving + still / 2, moving + still);
      writeExr(out_.pictures / (key + ".exr"), m.image);
      run["picture"] = key + ".exr";
    }
    if (!direct) {
      m.series.resize(size_t(moving));
      const std::vector<std::vector<bool>> seen(seen_.begin() + skipped, seen_.end());
      const PixelSeries wanted(truth.begin() + skipped, truth.end());
      std::vector<uint32_t> pixels(tracked_.points.size());
      for (uint32_t i = 0; i < pixels.size(); ++i) pixels[i] = i;
      const StabilityErrors e = stabilityErrors(toneMappedSeries(m.series, seen, watchedExposure_), wanted, pixels);
      run["moving"].update(Value::of("error", e.error, "change", e.change));
    }
    m.frames.resize(size_t(moving));
    for (StageId stage : m.stages()) run["stages"][kStageNames[size_t(stage)]] = m.ms(stage).median;
    run["rays"] = m.of([](const FrameStats& s) {
                     double rays = 0;
                     for (const FigureRow& row : figureTable())
                       if (const Figure f = row.value(s); const RayCounts* r = std::get_if<RayCounts>(&f))
                         rays += double(r->closest + r->occlusion);
                     return rays;
                   }).median;
    return run;
  }

  const AccuracyOptions& options_;
  const SweepFrames frames_;
  const fs::path folder_;
  const Study study_;
  LaunchContext& opened_;
  const std::string name_;
  const int samples_;
  std::string conditions_;
  bool punctual_ = false;
  double truthRelMse_[2] = {};
  TrackedPixels tracked_;
  std::vector<std::vector<bool>> seen_;
  PixelSeries watchedTruth_;
  float watchedExposure_ = 1;
  SweptScene out_;
};

} // namespace

SweptScene sweepScene(const AccuracyOptions& options, const std::string& file, const fs::path& folder,
                      const SweepFrames& frames) {
  return SceneSweep(options, file, folder, frames).run();
}

} // namespace lambent
