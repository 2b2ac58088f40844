#include "tools/lambent/study.h"

#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "gi/plan/techniques.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

Variant variantOf(const LaunchContext& opened, const std::string& name, const Assignments& set,
                  const std::string& technique) {
  Variant v{name, opened.settings, opened.seed};
  if (!technique.empty()) applyTechnique(v.settings, technique);
  for (const auto& [setting, value] : set) applySetting(v.settings, setting, value);
  return v;
}

std::vector<Variant> seeded(const std::vector<Variant>& variants, int seeds) {
  std::vector<Variant> out;
  for (const Variant& v : variants)
    for (int k = 0; k < seeds; ++k) out.emplace_back(v).seed += uint32_t(k);
  return out;
}

void lightByEveryTexel(Settings& settings) {
  applyTechnique(settings, "isr");
  settings.gather.mode = GatherMode::Full;
  settings.rsm.finest = settings.rsm.resolution;
  settings.rsm.depth = 0;
}

void useFewLights(MeasureOptions& options) {
  options.launch.set.insert(options.launch.set.begin(), {"smc.vpls=128", "smc.warmup=4"});
}

void needSampledLights(const std::string& technique) {
  if (!needsOf(techniqueByName(technique)).sampled())
    throw InputError("--technique " + technique, "has no sampled lights (smc, ir, mir and tcas have)");
}

RunPlan planOf(LaunchContext& opened, int frames) {
  const int all = opened.shot ? opened.shot->frameCount() : 60;
  const double fps = opened.shot ? opened.shot->fps : 30;
  return {.view = [&opened, fps](int frame) { return opened.at(frame / fps); },
          .frames = frames > 0 ? std::min(frames, all) : all};
}

RunPlan stillPlan(LaunchContext& opened, Buffer buffer, int frames, int skip) {
  return {.view = [&opened](int) { return opened.at(0); },
          .frames = frames,
          .skip = skip,
          .inTurn = false,
          .buffer = buffer};
}

std::function<SceneView(int)> watchedBy(WatchedScene& watched, std::function<SceneView(int)> view) {
  return [&watched, view = std::move(view)](int frame) {
    const SceneView shown = view(frame);
    watched.update(shown);
    return shown;
  };
}

std::vector<Measured> run(const std::vector<Variant>& variants, RunPlan plan, const std::string& doing, bool quiet) {
  Progress progress(doing, quiet);
  plan.cancelled = [] { return interrupted.load(); };
  plan.progress = [&](int done, int total) { progress.update(done, total); };
  return measure(variants, plan);
}

TracedImage trace(const SceneView& view, const Settings& settings, TracePlan plan, const std::string& doing,
                  bool quiet) {
  Progress progress(doing, quiet);
  plan.cancelled = [] { return interrupted.load(); };
  plan.stopped = &interrupted;
  plan.progress = [&](int done, int total) { progress.update(done, total); };
  return traceImage(view, settings, plan);
}

Assignments asInPaper1() {
  return {{"vpl.visibility", "maps"}, {"shadow.resolution", "128"}, {"gather.mode", "interleaved"},
          {"gather.disk", "0"},       {"gather.clamp", "10"}, // theirs is set by hand for each scene and not told
          {"gather.near", "0"},       {"filter.on", "on"},          {"history.frames", "0"},
          {"gather.glossy", "off"}};
}

double msOf(const FrameStats& stats, std::span<const StageId> stages) {
  double ms = 0;
  for (StageId stage : stages) ms += stats.ms(stage);
  return ms;
}
double msOf(const Measured& run, std::initializer_list<StageId> stages) {
  return run.of([&](const FrameStats& s) { return msOf(s, stages); }).median;
}
double frameMs(const Measured& run) {
  return run.of([](const FrameStats& s) { return s.wallMs; }).median;
}

std::string tableText(const std::vector<Column>& columns, const Value& rows) {
  std::vector<TableColumn> shown;
  for (const Column& c : columns) shown.push_back(c.shown);
  return tableText(shown, rows);
}

namespace {

LaunchOptions launchOf(const MeasureOptions& options, const std::string& scene, const Study::Defaults& defaults) {
  LaunchOptions launch = options.launch;
  launch.scene = scene;
  if (launch.size.empty()) launch.size = options.quick ? defaults.quickSize : defaults.size;
  Assignments set = defaults.set;
  if (options.clamp) set.emplace_back("gather.clamp", format("%.9g", *options.clamp));
  for (const auto& [name, value] : set) launch.set.insert(launch.set.begin(), name + "=" + value);
  return launch;
}

std::unique_ptr<LaunchContext> open(const LaunchOptions& launch, bool punctual, bool quiet) {
  std::unique_ptr<LaunchContext> opened = openLaunch(launch);
  if (punctual) needPunctualLight(*opened);
  say(*opened, quiet);
  return opened;
}

} // namespace

Study::Study(const MeasureOptions& options, const std::string& scene, const Defaults& defaults)
    : launch(launchOf(options, scene, defaults)), opened(open(launch, defaults.punctual, options.output.quiet)),
      options_(options) {}

std::vector<Measured> Study::draw(const std::vector<Variant>& variants, Buffer buffer, int frames) const {
  return run(variants, stillPlan(*opened, buffer, frames), "drawing", options_.output.quiet);
}

std::vector<Measured> Study::drawUpTo(int frame, const std::vector<Variant>& variants, Buffer buffer) const {
  RunPlan plan = planOf(*opened, frame + 1);
  plan.inTurn = false, plan.buffer = buffer;
  if (plan.frames <= frame) throw InputError("--frame", "the shot has only " + std::to_string(plan.frames));
  return run(variants, plan, "drawing", options_.output.quiet);
}

const TracedImage& Study::trace(int samples, ReferenceBuffer buffer, bool clamped, const std::filesystem::path& state,
                                int frame) {
  return traceView(planOf(*opened, 0).view(frame), samples, buffer, clamped, state);
}

const TracedImage& Study::traceView(const SceneView& view, int samples, ReferenceBuffer buffer, bool clamped,
                                    const std::filesystem::path& state) {
  traced = lambent::trace(view, opened->settings,
                          {.buffer = buffer,
                           .samples = uint32_t(options_.samples.value_or(options_.quick ? 64 : samples)),
                           .clamped = clamped,
                           .seed = opened->seed,
                           .state = state},
                          "tracing paths", options_.output.quiet);
  if (interrupted)
    throw RunError(state.empty() ? "interrupted before there was a result" : "interrupted: the same command goes on");
  truth = traced->image.mean;
  return *traced;
}

Outcome Study::outcome(const Measured& run) const {
  return {*this, run, truth.pixels.empty() ? ImageError{} : imageError(run.image, truth)};
}

Value Study::row(const std::vector<Column>& columns, const Measured& run) const {
  const Outcome from = outcome(run);
  const ImageError& e = from.error;
  Value row = Value::of();
  if (!truth.pixels.empty())
    row = Value::of("rmse", e.rmse, "rmse_share", e.rmseShare(), "rel_mse", e.relMse, "bias", e.bias);
  for (const Column& c : columns) {
    Value value = c.of ? c.of(from) : Value();
    if (!value.isNothing()) row[c.shown.key] = std::move(value);
  }
  return row;
}

Value Study::rows(const std::vector<Column>& columns, std::span<const Measured> runs) const {
  Value rows = Value::list();
  for (const Measured& run : runs) rows.add(row(columns, run));
  return rows;
}

void Study::report(const std::vector<Column>& columns, const Value& rows, Value figures) const {
  figures["scene"] = launch.scene;
  figures["rows"] = rows;
  if (traced)
    figures["truth"] =
        Value::of("spp", traced->samples, "clamp", traced->clamp, "relative_error", traced->image.relativeError,
                  "relative_error_of_mean", traced->image.relativeErrorOfMean);
  writeJson(options_.output.json, figures);
  if (options_.output.quiet) return;
  if (traced)
    std::printf("truth: %u paths per pixel, standard error %.2f %% per pixel (RMS), %.2f %% of the mean\n",
                traced->samples, 100 * traced->image.relativeError, 100 * traced->image.relativeErrorOfMean);
  std::printf("%s", tableText(columns, rows).c_str());
}

std::optional<double> pathsMs(const TracedImage& truth, double relMse) {
  return pathTracingMs(relMse, expectedRelMse(truth.image.mean, truth.image.error),
                       1000 * truth.sampleSeconds * truth.samples);
}

const char* holdsBar(const UncertainValue& times) {
  constexpr const char* kTexts[] = {"no", "yes", "within noise", "one seed"}; // by Order
  return kTexts[int(compared(times, {kPathTracingTimes, 0}))];
}

std::optional<double> steadyMs(const std::vector<FrameStats>& frames) {
  if (frames.size() < 2) return {};
  std::vector<double> ms;
  for (size_t i = frames.size() / 2; i < frames.size(); ++i) ms.push_back(frames[i].wallMs);
  return spreadOf(ms).median;
}

} // namespace lambent
