#include "tools/lambent/study.h"

#include "engine/core/error.h"
#include "engine/core/progress.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

Study::Study(const AccuracyOptions& options, const std::string& size, Assignments defaults)
    : launch(options.launch), options_(options) {
  if (launch.size.empty()) launch.size = options.quick ? "32x18" : size;
  if (options.quick) defaults.insert(defaults.end(), {{"smc.vpls", "128"}, {"smc.warmup", "4"}});
  if (options.clamp) defaults.emplace_back("gather.clamp", format("%.9g", *options.clamp));
  for (const auto& [name, value] : defaults) launch.set.insert(launch.set.begin(), name + "=" + value);
  stage = openLaunch(launch);
  say(*stage, options.output.quiet);
  context_.emplace(GlContext::headless());
}

Variant Study::variant(const std::string& name, const Assignments& assignments) const {
  Variant v{name, stage->settings, stage->seed};
  for (const auto& [setting, value] : assignments) applySetting(v.settings, setting, value);
  return v;
}

std::vector<Measured> Study::draw(const std::vector<Variant>& variants, Buffer buffer, int frames, int skip,
                                  bool inTurn) {
  Progress progress("drawing", options_.output.quiet);
  RunPlan plan = stillPlan(*stage, progress, buffer);
  plan.frames = frames, plan.skip = skip, plan.inTurn = inTurn;
  return measure(variants, plan);
}

std::vector<Measured> Study::drawUpTo(int frame, const std::vector<Variant>& variants, Buffer buffer) {
  Progress progress("drawing", options_.output.quiet);
  RunPlan plan = planOf(*stage, progress, frame + 1);
  plan.inTurn = false, plan.picture = buffer;
  if (plan.frames <= frame) throw InputError("--frame", "the shot has only " + std::to_string(plan.frames));
  return measure(variants, plan);
}

const TracedPicture& Study::trace(int samples, ReferenceBuffer buffer, bool clamped, const std::filesystem::path& state,
                                  int frame) {
  Progress progress("tracing paths", options_.output.quiet);
  const RunPlan plan = planOf(*stage, progress, 0);
  truth = tracePicture(plan.view(frame), stage->settings,
                       {.buffer = buffer,
                        .samples = uint32_t(options_.samples.value_or(options_.quick ? 64 : samples)),
                        .clamped = clamped,
                        .seed = stage->seed,
                        .state = state,
                        .cancelled = plan.cancelled,
                        .progress = plan.progress});
  if (interrupted)
    throw RunError(state.empty() ? "interrupted before there was a result" : "interrupted: the same command goes on");
  return *truth;
}

void Study::report(const std::vector<TableColumn>& columns, const nlohmann::json& rows, nlohmann::json figures) const {
  figures["scene"] = launch.scene;
  figures["rows"] = rows;
  if (truth)
    figures["truth"] = {{"spp", truth->samples},
                        {"clamp", truth->clamp},
                        {"relative_error", truth->picture.relativeError},
                        {"relative_error_of_mean", truth->picture.relativeErrorOfMean}};
  writeJson(options_.output.json, figures);
  if (options_.output.quiet) return;
  if (truth)
    std::printf("truth: %u paths per pixel, standard error %.2f %% per pixel (RMS), %.2f %% of the mean\n",
                truth->samples, 100 * truth->picture.relativeError, 100 * truth->picture.relativeErrorOfMean);
  std::printf("%s", tableText(columns, rows).c_str());
}

nlohmann::json rowOf(const PictureError& e) {
  return {{"rmse", e.rmse}, {"rmse_share", e.rmseShare()}, {"rel_mse", e.relMse}, {"bias", e.bias}};
}

std::optional<double> pathsMs(const TracedPicture& truth, double relMse) {
  return pathTracingMs(relMse, expectedRelMse(truth.picture.mean, truth.picture.error),
                       1000 * truth.sampleSeconds * truth.samples);
}

const char* holdsBar(const UncertainValue& times) {
  switch (compared(times, {kPathTracingTimes, 0})) {
  case Order::Greater:
    return "yes";
  case Order::Less:
    return "no";
  case Order::Unknown:
    return "one seed";
  default:
    return "within noise";
  }
}

std::optional<double> steadyMs(const std::vector<FrameStats>& frames) {
  if (frames.size() < 2) return {};
  std::vector<double> ms;
  for (size_t i = frames.size() / 2; i < frames.size(); ++i) ms.push_back(frames[i].wallMs);
  return spreadOf(ms).median;
}

} // namespace lambent
