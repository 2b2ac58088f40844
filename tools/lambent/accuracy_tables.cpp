// lambent accuracy SCENE --convergence, --gathers, --presets, --figure 8|9|10: tables of pictures of one view under
// changing settings, held to path tracing or to one among them.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "gi/reference/traced_picture.h"
#include "tools/lambent/accuracy.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Settings by name, as on the command line.
using Assignments = std::vector<std::pair<std::string, std::string>>;

Variant variantOf(const std::string& name, const Stage& stage, const Assignments& assignments) {
  Variant v{name, stage.settings, stage.seed};
  for (const auto& [setting, value] : assignments) applySetting(v.settings, setting, value);
  return v;
}

struct Opened {
  LaunchOptions launch;
  std::unique_ptr<Stage> stage;
  std::unique_ptr<GlContext> context;
};

/// The stage with defaults under what the command line says. `size` is that of the form, where none is given.
Opened openFor(const AccuracyOptions& options, const std::string& size, const Assignments& defaults = {}) {
  Opened out{options.launch, nullptr, nullptr};
  if (out.launch.size.empty()) out.launch.size = options.quick ? "32x18" : size;
  Assignments first = defaults;
  if (options.quick) first.insert(first.end(), {{"smc.vpls", "128"}, {"smc.warmup", "4"}, {"smc.points", "256"}});
  if (options.clamp) first.emplace_back("gather.clamp", format("%.9g", *options.clamp));
  for (size_t i = first.size(); i-- > 0;)
    out.launch.set.insert(out.launch.set.begin(), first[i].first + "=" + first[i].second);
  out.stage = openStage(out.launch);
  say(*out.stage, options.output.quiet);
  out.context = std::make_unique<GlContext>(GlContext::headless());
  return out;
}

void needClamp(const AccuracyOptions& options) {
  if (!(options.clamp.value_or(0) > 0))
    throw InputError("--clamp", "is needed here (largest geometry term on both sides, in 1/m^2: --clamp 10)");
}

std::vector<Measured> draw(const AccuracyOptions& options, Stage& stage, const std::vector<Variant>& variants,
                           Buffer buffer, int frames = 1, int skip = 0, bool inTurn = false) {
  Progress progress("drawing", options.output.quiet);
  RunPlan plan = stillPlan(stage, progress, buffer);
  plan.frames = frames, plan.skip = skip, plan.inTurn = inTurn;
  return measure(variants, plan);
}

/// `state` keeps the sums; empty: nothing does.
TracedPicture trace(const AccuracyOptions& options, Stage& stage, int samples, ReferenceBuffer buffer, bool clamped,
                    const fs::path& state = {}) {
  Progress progress("tracing paths", options.output.quiet);
  TracedPicture traced = tracePicture(stage.at(0), stage.settings,
                                      {.buffer = buffer,
                                       .samples = uint32_t(options.samples.value_or(options.quick ? 64 : samples)),
                                       .clamped = clamped,
                                       .seed = stage.seed,
                                       .state = state,
                                       .cancelled = [] { return interrupted.load(); },
                                       .progress = [&](int done, int total) { progress.update(done, total); }});
  if (interrupted)
    throw RunError(state.empty() ? "interrupted: nothing is written" : "interrupted: the same command goes on");
  return traced;
}

nlohmann::json rowOf(const PictureError& e) {
  return {{"rmse", e.rmse}, {"rmse_share", e.rmseShare()}, {"rel_mse", e.relMse}, {"bias", e.bias}};
}

/// The table, with what its truth is known by.
void report(const AccuracyOptions& options, const std::vector<TableColumn>& columns, const nlohmann::json& rows,
            const TracedPicture* truth, const nlohmann::json& more = nlohmann::json::object()) {
  nlohmann::json figures{{"scene", options.launch.scene}, {"rows", rows}};
  figures.update(more);
  if (truth)
    figures["truth"] = {{"spp", truth->samples},
                        {"clamp", truth->clamp},
                        {"relative_error", truth->picture.relativeError},
                        {"relative_error_of_mean", truth->picture.relativeErrorOfMean}};
  writeJson(options.output.json, figures);
  if (options.output.quiet) return;
  if (truth)
    std::printf("truth: %u paths per pixel, standard error %.2f %% per pixel (RMS), %.2f %% of the mean\n",
                truth->samples, 100 * truth->picture.relativeError, 100 * truth->picture.relativeErrorOfMean);
  std::printf("%s", tableText(columns, rows).c_str());
}

const TableColumn kRmseShare{"rmse_share", "RMSE over mean", "%.2f %%", 100}, kRelMse{"rel_mse", "relMSE", "%.4f"},
    kBias{"bias", "bias", "%+.1f %%", 100};

} // namespace

void accuracyConvergence(const AccuracyOptions& options) {
  needClamp(options);
  const Opened opened = openFor(options, "64x36", {{"gather.disk", "0"}, {"vpl.visibility", "rays"}});
  Stage& stage = *opened.stage;
  const TracedPicture truth = trace(options, stage, 4096, ReferenceBuffer::Irradiance, true);
  const std::vector<double> counts =
      options.quick ? std::vector<double>{64, 256} : std::vector<double>{512, 2048, 8192};
  const int seeds = options.seeds.value_or(options.quick ? 1 : 3);
  std::vector<Variant> variants;
  for (const char* density : {"cells", "knn"})
    for (double vpls : counts)
      for (int k = 0; k < seeds; ++k) {
        variants.push_back(variantOf(density, stage, {{"smc.density", density}, {"smc.vpls", format("%g", vpls)}}));
        variants.back().seed += uint32_t(k);
      }
  const std::vector<Measured> runs = draw(options, stage, variants, Buffer::Irradiance);

  nlohmann::json rows, exponents;
  std::vector<double> errors;
  for (size_t i = 0; i < runs.size(); i += size_t(seeds)) {
    const Variant& v = runs[i].variant;
    nlohmann::json row{{"density", v.name}, {"vpls", v.settings.smc.vpls}};
    double square = 0;
    for (int k = 0; k < seeds; ++k) {
      const PictureError e = pictureError(runs[i + size_t(k)].picture, truth.picture.mean);
      square += e.rmseShare() * e.rmseShare() / seeds;
      row["bias"].push_back(e.bias);
    }
    // What the truth does not know is no error of the lights.
    errors.push_back(std::sqrt(std::max(square - std::pow(truth.picture.relativeError, 2), 1e-12)));
    row["rmse_share"] = errors.back();
    rows.push_back(row);
    if (errors.size() == counts.size()) {
      exponents[v.name] = exponentOf(counts, errors);
      errors.clear();
    }
  }
  report(options, {{"density", "density"}, {"vpls", "N"}, kBias, kRmseShare}, rows, &truth, {{"exponents", exponents}});
  for (const auto& [density, exponent] : exponents.items())
    if (!options.output.quiet) std::printf("%s: RMSE falls as N^%.2f\n", density.c_str(), exponent.get<double>());
}

void accuracyGathers(const AccuracyOptions& options) {
  const Opened opened = openFor(options, "320x180");
  Stage& stage = *opened.stage;
  std::vector<Variant> variants{variantOf("full", stage, {{"gather.mode", "full"}})};
  for (const char* mode : {"interleaved", "multires-interleaved", "multires"})
    variants.push_back(variantOf(mode, stage, {{"gather.mode", mode}}));
  variants.insert(variants.begin() + 3, variants[2]);
  variants[3].name += ", multires.normal=0.7, multires.depth=0.1";
  variants[3].settings.multires.normal = 0.7f;
  variants[3].settings.multires.depth = 0.1f;
  for (Variant& v : variants) v.settings.effects[EffectId::Redraw] = EffectMode::On;
  const std::vector<Measured> runs =
      draw(options, stage, variants, Buffer::Irradiance, options.quick ? 3 : 8, options.quick ? 1 : 2, true);
  const auto ms = [](const Measured& m) {
    double sum = 0;
    for (StageId s : {StageId::Patches, StageId::Stencil, StageId::Gather, StageId::Upsample, StageId::Filter})
      sum += m.ms(s).median;
    return sum;
  };
  nlohmann::json rows;
  for (size_t i = 1; i < runs.size(); ++i) {
    rows.push_back(rowOf(pictureError(runs[i].picture, runs[0].picture)));
    rows.back().update({{"gather", runs[i].variant.name}, {"ms", ms(runs[i])}, {"ratio", ms(runs[i]) / ms(runs[1])}});
  }
  report(options,
         {{"gather", "gather"}, {"ms", "ms", "%.0f"}, {"ratio", "of interleaved", "%.2f"}, kRmseShare, kRelMse}, rows,
         nullptr);
}

void accuracyPresets(const AccuracyOptions& options) {
  const Opened opened = openFor(options, "160x90");
  const TracedPicture truth = trace(options, *opened.stage, 8192, ReferenceBuffer::Irradiance, false);
  const int seeds = options.seeds.value_or(options.quick ? 1 : 2);
  std::vector<Variant> variants;
  for (const std::string& preset : presetNames()) {
    LaunchOptions launch = opened.launch;
    launch.preset = preset; // under what the command line sets
    for (int k = 0; k < seeds; ++k)
      variants.push_back({preset, openStage(launch)->settings, launch.seed + uint32_t(k)});
  }
  nlohmann::json rows;
  for (const Measured& m : draw(options, *opened.stage, variants, Buffer::Irradiance, 4, 3)) {
    rows.push_back(rowOf(pictureError(m.picture, truth.picture.mean)));
    rows.back().update({{"preset", m.variant.name}, {"seed", m.variant.seed}, {"ms", m.frames.back().wallMs}});
  }
  report(options,
         {{"preset", "preset"},
          {"seed", "seed"},
          {"ms", "ms per frame", "%.0f"},
          {"rmse", "RMSE", "%.4f"},
          kRelMse,
          kBias},
         rows, &truth);
}

void accuracyFigure(const AccuracyOptions& options) {
  if (options.figure != 9) needClamp(options);
  const fs::path folder = reportFolder(options.output.out, format("out/figure-%d", options.figure));
  const Opened opened = openFor(options, "320x180", {{"gather.disk", "0"}});
  Stage& stage = *opened.stage;
  const bool quick = options.quick;

  // What pictures are held to comes first.
  std::vector<Variant> variants;
  if (options.figure == 8) {
    variants.push_back(variantOf("interleaved", stage, {}));
    variants.push_back(variantOf("all-maps", stage, {{"gather.mode", "full"}}));
    variants.push_back(variantOf("all-rays", stage, {{"vpl.visibility", "rays"}}));
  } else if (options.figure == 9) {
    variants.push_back(variantOf("rays", stage, {{"vpl.visibility", "rays"}}));
    for (const char* texels : {"128", "256", "512", "1024"}) {
      if (quick && variants.size() > 2) break;
      variants.push_back(
          variantOf(std::string("maps-") + texels, stage, {{"gather.mode", "full"}, {"shadow.resolution", texels}}));
    }
  } else {
    for (const char* vpls : quick ? std::vector{"64", "256"} : std::vector{"2000", "8000", "40000"})
      variants.push_back(
          variantOf(std::string("vpls-") + vpls, stage, {{"vpl.visibility", "rays"}, {"smc.vpls", vpls}}));
  }
  std::vector<std::pair<std::string, Image>> truths;
  std::optional<TracedPicture> traced;
  const auto path = [&](const std::string& name, bool clamped) {
    traced = trace(options, stage, 1024, ReferenceBuffer::Indirect, clamped, folder / (name + ".state"));
    truths.emplace_back(name, traced->picture.mean);
  };
  if (options.figure == 8) path("path-tracing", false);
  if (options.figure != 9) path("clamped-path-tracing", true);
  std::vector<Measured> runs = draw(options, stage, variants, Buffer::Indirect);
  const float exposure = traced ? traced->exposure : runs[0].exposure;
  if (options.figure == 9) {
    truths.emplace_back(runs[0].variant.name, runs[0].picture);
    runs.erase(runs.begin());
  }
  const auto write = [&](const std::string& name, const Image& picture) {
    for (const char* extension : {".exr", ".png"})
      writePicture((folder / (name + extension)).string(), picture, exposure);
  };
  nlohmann::json rows;
  for (const auto& [name, picture] : truths) write(name, picture);
  for (const Measured& m : runs) {
    write(m.variant.name, m.picture);
    for (const auto& [name, truth] : truths) {
      rows.push_back(rowOf(pictureError(m.picture, truth)));
      rows.back().update({{"picture", m.variant.name}, {"against", name}});
      writePicture((folder / (m.variant.name + "-minus-" + name + ".png")).string(),
                   absoluteDifference(m.picture, truth), midGreyAt(pictureError(truth, truth).meanTruth));
    }
  }
  report(options, {{"picture", "picture"}, {"against", "against"}, kRmseShare, kRelMse, kBias}, rows,
         traced ? &*traced : nullptr);
  if (!options.output.quiet) std::printf("pictures: %s\n", folder.c_str());
}

} // namespace lambent
