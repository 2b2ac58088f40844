#include "tools/lambent/sweep.h"

#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/core/rng.h"
#include "engine/gl/program.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "gi/measure/stability.h"
#include "gi/plan/techniques.h"
#include "gi/reference/traced_picture.h"
#include "tools/lambent/conditions.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr int kGrid = 16;            // watched pixels besides the shot's own, squared
constexpr int kBetweenControls = 10; // runs
constexpr int kControlSeeds = 4;     // of the default: what chance does to an error

/// Lines of JSON that are kept as they come. A line that a kill left half written is left out.
class RunLog {
 public:
  RunLog(fs::path file, std::string conditions) : file_(std::move(file)), conditions_(std::move(conditions)) {
    std::ifstream in(file_);
    int session = 0;
    for (std::string line; std::getline(in, line);) {
      const nlohmann::json run = nlohmann::json::parse(line, nullptr, false);
      if (run.is_discarded()) continue;
      session = std::max(session, run.value("session", 0));
      if (run.value("conditions", "") == conditions_) runs_.push_back(run);
    }
    session_ = session + 1;
  }

  bool has(const std::string& key) const {
    return std::ranges::any_of(runs_, [&](const nlohmann::json& run) { return run["key"] == key; });
  }

  void add(const std::string& key, nlohmann::json run) {
    run.update({{"key", key}, {"session", session_}, {"conditions", conditions_}});
    std::ofstream out(file_, std::ios::app);
    out << (begun_ ? "" : "\n") << run.dump() << '\n'; // not behind half a line
    if (!out.flush()) throw RunError(file_.string() + ": cannot be written");
    begun_ = true;
    runs_.push_back(std::move(run));
  }

  const std::vector<nlohmann::json>& runs() const { return runs_; }

 private:
  const fs::path file_;
  const std::string conditions_;
  std::vector<nlohmann::json> runs_;
  int session_ = 1;
  bool begun_ = false;
};

class SceneSweep {
 public:
  SceneSweep(const AccuracyOptions& options, const std::string& file, const fs::path& folder, const SweepFrames& frames)
      : options_(options), frames_(frames), folder_(folder) {
    LaunchOptions launch = options.launch;
    launch.scene = file;
    if (launch.size.empty()) launch.size = options.quick ? "48x27" : "128x72";
    stage_ = openLaunch(launch);
    refuseGlossy(stage_->settings);
    say(*stage_, options.output.quiet);
    name_ = fs::path(file).stem().string();
    context_.emplace(GlContext::headless());
    samples_ = options.samples.value_or(options.quick ? 64 : 2048);
    punctual_ = std::ranges::any_of(stage_->at(0).lights,
                                    [](const LightView& light) { return maxComponent(light.intensity) > 0; });
    out_.name = name_;
    conditions_ =
        conditionsOf(*stage_, launch,
                     format("%d %d %d %d %d", samples_, frames_.moving, frames_.still, frames_.slow, launch.threads));
    out_.pictures = folder_ / ("pictures-" + name_ + "-" + conditions_); // not beside another program's
    reportFolder(out_.pictures.string(), {});
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
    for (const nlohmann::json& run : log.runs()) out_.runs.push_back(run);
    return std::move(out_);
  }

 private:
  static size_t controls(const RunLog& log) {
    return size_t(std::ranges::count_if(log.runs(), [](const nlohmann::json& run) { return run.contains("control"); }));
  }

  void addControl(RunLog& log, const SweepPoint& standard, int& control) {
    std::string key;
    do key = format("control %d", control++);
    while (log.has(key));
    nlohmann::json run = measured(standard, (control - 1) % kControlSeeds, key);
    run["control"] = true;
    log.add(key, std::move(run));
  }

  SceneView viewAt(int frame) {
    const double fps = stage_->shot ? stage_->shot->fps : 30;
    return stage_->at(std::min(frame, frames_.moving - 1) / fps);
  }

  void traceTruths() {
    const char* names[] = {"indirect", "direct"};
    for (KnobLight light : {KnobLight::Indirect, KnobLight::Direct}) {
      const std::string name = names[int(light)];
      Progress progress(name_ + ": truth of " + name + " light", options_.output.quiet);
      const std::string file = "truth-" + name_ + "-" + name + "-" + conditions_;
      const fs::path state = folder_ / (file + ".state"), pace = folder_ / (file + ".ms");
      const TracedPicture traced =
          tracePicture(viewAt(frames_.moving - 1), stage_->settings,
                       {.buffer = light == KnobLight::Indirect ? ReferenceBuffer::Irradiance : ReferenceBuffer::Direct,
                        .samples = uint32_t(light == KnobLight::Indirect ? samples_ : std::max(samples_ / 8, 2)),
                        .seed = stage_->seed,
                        .state = state,
                        .cancelled = [] { return interrupted.load(); },
                        .progress = [&](int done, int total) { progress.update(done, total); }});
      if (interrupted) throw RunError("interrupted: the same command goes on");
      const ReferencePicture& p = traced.picture;
      out_.truths[int(light)] = p.mean;
      truthRelMse_[int(light)] = expectedRelMse(p.mean, p.error);
      out_.truth[name] = {{"spp", traced.samples},
                          {"relative_error_of_mean", p.relativeErrorOfMean},
                          {"rel_mse", truthRelMse_[int(light)]},
                          {"seed", stage_->seed}};
      double sampleMs = 0; // of the pass that took samples; later ones find them all there
      if (traced.sampleSeconds > 0) writeText(pace, format("%.9g", 1000 * traced.sampleSeconds));
      std::ifstream(pace) >> sampleMs;
      out_.truth[name]["sample_ms"] = sampleMs;
    }
    out_.exposure = exposureFor(out_.truths[0].pixels);
  }

  /// Path traced values of the watched pixels, when first needed.
  const PixelSeries& watchedTruth() {
    if (!watchedTruth_.empty()) return watchedTruth_;
    const Shot none;
    tracked_ = trackedPixels(stage_->shot ? *stage_->shot : none, options_.quick ? 4 : kGrid);
    WatchedScene watched(tracked_.points);
    Progress progress(name_ + ": truth of watched pixels", options_.output.quiet);
    RunPlan plan = planOf(*stage_, progress, frames_.moving);
    plan.frames = frames_.moving;
    plan.view = [&](int frame) {
      const SceneView view = viewAt(frame);
      watched.update(view);
      return view;
    };
    plan.points = tracked_.points;
    const Measured truth =
        measure({{"truth", stage_->settings, stage_->seed, pathsAtPoints(watched, uint32_t(samples_ / 2))}}, plan)[0];
    std::vector<vec3> first;
    for (const TrackedValue& v : truth.series[0]) first.push_back(v.radiance);
    watchedExposure_ = exposureFor(first);
    seen_ = watched.seen();
    return watchedTruth_ = toneMappedSeries(truth.series, seen_, watchedExposure_);
  }

  nlohmann::json errorsOf(const Image& picture, KnobLight light) const {
    const PictureError e = pictureError(picture, out_.truths[int(light)]);
    // What the truth does not know is no error of the picture, down to a tenth of it.
    const double relMse = std::max(e.relMse - truthRelMse_[int(light)], 0.1 * truthRelMse_[int(light)]);
    return {{"rel_mse", relMse}, {"rmse_share", e.rmseShare()}, {"bias", e.bias}};
  }

  nlohmann::json measured(const SweepPoint& point, int seed, const std::string& key) {
    const bool direct = point.light == KnobLight::Direct;
    Variant variant{point.name, stage_->settings, stage_->seed + uint32_t(seed)};
    if (!point.technique.empty()) applyTechnique(variant.settings, point.technique);
    for (const auto& [setting, value] : point.set) applySetting(variant.settings, setting, value);
    if (direct) variant.settings.effects[EffectId::Indirect] = EffectMode::Off;
    variant.settings.effects[EffectId::Redraw] = EffectMode::On; // what sleeps would cost nothing
    const PixelSeries& truth = watchedTruth();

    const int moving = point.slow ? std::min(frames_.slow, frames_.moving) : frames_.moving;
    const int still = point.slow || direct ? 0 : frames_.still, skipped = frames_.moving - moving;
    RunPlan plan;
    plan.frames = moving + still;
    plan.view = [&](int frame) { return viewAt(skipped + frame); };
    plan.inTurn = false;
    plan.picture = direct ? Buffer::Direct : Buffer::Irradiance;
    if (still > 0) plan.also = {moving - 1};
    if (!direct) plan.points = tracked_.points;
    plan.cancelled = [] { return interrupted.load(); };
    Measured m = [&] {
      try {
        return measure({variant}, plan)[0];
      } catch (const RunError&) {
        if (interrupted) throw RunError("interrupted: the same command goes on");
        throw;
      }
    }();

    const auto medianMs = [&](int from, int to) {
      std::vector<double> ms;
      for (int f = from; f < to; ++f) ms.push_back(m.frames[size_t(f)].wallMs);
      return spreadOf(std::move(ms)).median;
    };
    nlohmann::json run{{"point", point.name}, {"seed", seed}, {"gpu_mib", double(m.gpuBytes) / (1 << 20)}};
    run["moving"] = errorsOf(still > 0 ? m.before[0] : m.picture, point.light);
    run["moving"]["ms"] = medianMs(std::min(2, moving - 1), moving); // shaders and maps of the first are past
    if (still > 0) {
      run["still"] = errorsOf(m.picture, point.light);
      run["still"]["ms"] = medianMs(moving + still / 2, moving + still);
      writeExr(out_.pictures / (key + ".exr"), m.picture);
      run["picture"] = key + ".exr";
    }
    if (!direct) {
      m.series.resize(size_t(moving));
      const std::vector<std::vector<bool>> seen(seen_.begin() + skipped, seen_.end());
      const PixelSeries wanted(truth.begin() + skipped, truth.end());
      std::vector<uint32_t> pixels(tracked_.points.size());
      for (uint32_t i = 0; i < pixels.size(); ++i) pixels[i] = i;
      const StabilityErrors e = stabilityErrors(toneMappedSeries(m.series, seen, watchedExposure_), wanted, pixels);
      run["moving"].update({{"error", e.error}, {"change", e.change}});
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
  std::unique_ptr<LaunchContext> stage_;
  std::optional<GlContext> context_;
  std::string name_, conditions_;
  int samples_ = 0;
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
