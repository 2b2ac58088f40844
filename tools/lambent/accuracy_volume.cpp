// lambent accuracy SCENE --volume: error of light propagation volumes by what their settings take, beside lights that
// every pixel gathers, against path tracing.
#include "tools/lambent/study.h"

#include "engine/core/error.h"

namespace lambent {

void accuracyVolume(const AccuracyOptions& options) {
  Study study(options, "160x90");
  const Image truth = study.trace(1024, ReferenceBuffer::Irradiance, false).picture.mean;
  std::vector<Variant> variants;
  const auto add = [&](const std::string& technique, const Assignments& set) {
    std::string name = technique;
    for (const auto& [setting, value] : set) name += ", " + setting + "=" + value;
    Variant v{name, study.stage->settings, study.stage->seed};
    applyTechnique(v.settings, technique);
    for (const auto& [setting, value] : set) applySetting(v.settings, setting, value);
    variants.push_back(std::move(v));
  };
  add("smc", {});
  if (!study.stage->at(0).lights.empty()) add("rsm", {});
  add("lpv", {});
  for (const Assignments& set : std::vector<Assignments>{{{"lpv.cells", "8"}, {"lpv.steps", "16"}},
                                                         {{"lpv.cells", "32"}, {"lpv.steps", "64"}},
                                                         {{"lpv.cells", "64"}, {"lpv.steps", "128"}},
                                                         {{"lpv.steps", "16"}},
                                                         {{"lpv.steps", "64"}},
                                                         {{"lpv.occlusion", "off"}},
                                                         {{"smc.vpls", "512"}},
                                                         {{"smc.vpls", "8192"}},
                                                         {{"smc.bounces", "1"}}}) {
    add("lpv", set);
    if (options.quick) break;
  }
  nlohmann::json rows;
  for (const Measured& m : study.draw(variants, Buffer::Irradiance)) {
    rows.push_back(rowOf(pictureError(m.picture, truth)));
    rows.back().update({{"technique", m.variant.name},
                        {"steps_ms", m.ms(StageId::Propagate).median},
                        {"rays", m.frames.back().raysVolume.occlusion}});
  }
  study.report({{"technique", "technique"},
                kBias,
                kRmseShare,
                kRelMse,
                {"steps_ms", "steps, ms (shaders too)", "%.0f"},
                {"rays", "rays of the grid", "%.0f"}},
               rows);
}

} // namespace lambent
