// lambent accuracy SCENE --convergence, --gathers, --light, --direct, --presets: tables of pictures of
// one view under changing settings, held to path tracing or to one among them.
#include "engine/core/error.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

void accuracyConvergence(const AccuracyOptions& options) {
  needClamp(options);
  Study study(options, "64x36",
              {{"gather.disk", "0"}, {"gather.near", "0"}, {"history.frames", "0"}, {"vpl.visibility", "rays"}});
  const ReferencePicture truth = study.trace(4096, ReferenceBuffer::Irradiance, true).picture;
  const std::vector<double> counts =
      options.quick ? std::vector<double>{64, 256} : std::vector<double>{512, 2048, 8192};
  const int seeds = options.seeds.value_or(options.quick ? 1 : 3);
  std::vector<Variant> variants;
  for (const char* density : {"cells", "knn"})
    for (double vpls : counts)
      for (int k = 0; k < seeds; ++k) {
        variants.push_back(study.variant(density, {{"smc.density", density}, {"smc.vpls", format("%g", vpls)}}));
        variants.back().seed += uint32_t(k);
      }
  const std::vector<Measured> runs = study.draw(variants, Buffer::Irradiance);

  nlohmann::json rows, exponents;
  std::vector<double> errors;
  for (size_t i = 0; i < runs.size(); i += size_t(seeds)) {
    const Variant& v = runs[i].variant;
    nlohmann::json row{{"density", v.name}, {"vpls", v.settings.smc.vpls}};
    double square = 0;
    for (int k = 0; k < seeds; ++k) {
      const PictureError e = pictureError(runs[i + size_t(k)].picture, truth.mean);
      square += e.rmseShare() * e.rmseShare() / seeds;
      row["bias"].push_back(e.bias);
    }
    // What the truth does not know is no error of the lights.
    errors.push_back(std::sqrt(std::max(square - std::pow(truth.relativeError, 2), 1e-12)));
    row["rmse_share"] = errors.back();
    rows.push_back(row);
    if (errors.size() == counts.size()) {
      exponents[v.name] = exponentOf(counts, errors);
      errors.clear();
    }
  }
  study.report({{"density", "density"}, {"vpls", "N"}, kBias, kRmseShare}, rows, {{"exponents", exponents}});
  for (const auto& [density, exponent] : exponents.items())
    if (!options.output.quiet) std::printf("%s: RMSE falls as N^%.2f\n", density.c_str(), exponent.get<double>());
}

void accuracyGathers(const AccuracyOptions& options) {
  Study study(options, "320x180", {{"gather.near", "0"}, {"history.frames", "0"}}); // the same for all of them
  std::vector<Variant> variants{study.variant("full", {{"gather.mode", "full"}})};
  for (const char* mode : {"interleaved", "multires-interleaved", "multires"})
    variants.push_back(study.variant(mode, {{"gather.mode", mode}}));
  variants.insert(variants.begin() + 3, variants[2]);
  variants[3].name += ", multires.normal=0.7, multires.depth=0.1";
  variants[3].settings.multires.normal = 0.7f;
  variants[3].settings.multires.depth = 0.1f;
  for (Variant& v : variants) v.settings.effects[EffectId::Redraw] = EffectMode::On;
  const std::vector<Measured> runs =
      study.draw(variants, Buffer::Irradiance, options.quick ? 3 : 8, options.quick ? 1 : 2, true);
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
  study.report({{"gather", "gather"}, {"ms", "ms", "%.0f"}, {"ratio", "of interleaved", "%.2f"}, kRmseShare, kRelMse},
               rows);
}

void accuracyLight(const AccuracyOptions& options) {
  Study study(options, "160x90");
  if (options.frame > 0 && !study.stage->shot) throw InputError(study.launch.scene, "is no shot (--frame needs one)");
  const Image truth = study.trace(2048, ReferenceBuffer::Irradiance, false, {}, options.frame).picture.mean;
  const Image most = allButBrightest(truth, 0.01);
  const int averaged = study.stage->settings.history.frames;
  struct Way {
    const char* name;
    Assignments assignments;
    int frames; // of a still view
  };
  std::vector<Way> ways{{"as set", {}, std::max(1, averaged)}, {"one picture", {{"history.frames", "0"}}, 1}};
  if (options.frame == 0) // as many near rays as averaged pictures have
    ways.push_back({"all, rays", {{"gather.mode", "full"}, {"vpl.visibility", "rays"}, {"gather.near", "32"}}, 1});
  if (options.alone) ways.resize(1);
  nlohmann::json rows;
  for (const Way& way : ways) {
    std::vector<Variant> variants;
    for (int k = 0; k < options.seeds.value_or(options.quick ? 1 : 3); ++k) {
      variants.push_back(study.variant(way.name, way.assignments));
      variants.back().seed += uint32_t(k);
    }
    for (const Measured& m : options.frame > 0 ? study.drawUpTo(options.frame, variants, Buffer::Irradiance)
                                               : study.draw(variants, Buffer::Irradiance, way.frames)) {
      rows.push_back(rowOf(pictureError(m.picture, truth)));
      rows.back().update({{"lights", m.variant.name},
                          {"seed", m.variant.seed},
                          {"bias_most", pictureError(m.picture, truth, most).bias},
                          {"blocks", blocksWithin(m.picture, truth, 10, 0.06)}});
      const auto ms = steadyMs(m.frames), paths = pathsMs(*study.truth, rows.back()["rel_mse"]);
      if (ms) rows.back()["ms"] = *ms;
      if (paths) rows.back()["paths_ms"] = *paths;
      if (ms && paths) rows.back()["times"] = *paths / *ms;
    }
  }
  study.report({{"lights", "lights"},
                {"seed", "seed"},
                kBias,
                {"bias_most", "but the brightest 1 %", "%+.1f %%", 100},
                {"blocks", "blocks within 6 %", "%.0f %%", 100},
                kRelMse,
                {"ms", "ms a frame", "%.0f"},
                {"paths_ms", "ms of path tracing to that error", "%.0f"},
                {"times", "times the frame", "%.1f"}},
               rows);
}

void accuracyDirect(const AccuracyOptions& options) {
  Study study(options, "320x180", {{"effects.indirect", "off"}});
  const Image truth = study.trace(256, ReferenceBuffer::Direct, false).picture.mean;
  const Image most = allButBrightest(truth, 0.01);
  std::vector<Variant> variants{study.variant("as set", {})};
  if (!options.alone) {
    variants.push_back(study.variant("maps alone", {{"shadow.rays", "off"}}));
    variants.push_back(study.variant("64 emissive samples", {{"shadow.emitterSamples", "64"}}));
  }
  nlohmann::json rows;
  for (const Measured& m : study.draw(variants, Buffer::Direct)) {
    rows.push_back(rowOf(pictureError(m.picture, truth)));
    rows.back().update({{"shadows", m.variant.name},
                        {"rays", m.frames.back().raysShadows.occlusion},
                        {"bias_most", pictureError(m.picture, truth, most).bias}});
  }
  study.report({{"shadows", "shadows"},
                {"rays", "rays", "%.0f"},
                kBias,
                {"bias_most", "but the brightest 1 %", "%+.1f %%", 100},
                kRelMse},
               rows);
}

} // namespace lambent
