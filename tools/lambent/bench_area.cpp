// lambent bench --area SCENE...: paper 4's table 1. Direct light of emissive surfaces at patches of the picture as set,
// at those of paper 4 (quarters whose answers differ by one bit), at those of Nichols et al. 2010 (nine patches whose
// answers do, upsampling level by level), and at every pixel; with lamps as they are, and with lamps of a quarter of
// their width. Time with visibility found anew in every frame; error against path tracing.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/picture_error.h"
#include "gi/reference/traced_picture.h"
#include "tools/lambent/accuracy.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/text.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOurs = "as set";
constexpr const char* kPaper = "paper 4";
constexpr const char* kBefore = "predecessor";
constexpr const char* kBrute = "every pixel";

/// Views of a stage with all that glows scaled about the middle of its bounds.
class ScaledLamps {
 public:
  explicit ScaledLamps(float scale) : scale_(scale) {}

  SceneView of(SceneView view) {
    instances_.assign(view.instances.begin(), view.instances.end());
    for (InstanceView& in : instances_) {
      const Mesh& mesh = view.assets->meshes[in.mesh];
      const bool glows = std::ranges::any_of(mesh.primitives, [&](const Primitive& p) {
        return maxComponent(view.assets->materials[p.material].emission) > 0;
      });
      if (!glows || scale_ == 1) continue;
      const vec3 middle = in.boundsWorld.centre();
      mat4 scaled = glm::translate(mat4(1), middle);
      scaled = glm::translate(glm::scale(scaled, vec3(scale_)), -middle);
      in.worldFromObject = in.worldFromObjectBefore = scaled * in.worldFromObject;
      in.boundsWorld = in.boundsWorldBefore = transformed(mesh.boundsObject, in.worldFromObject);
      lamps = true;
    }
    view.instances = instances_;
    view.changes.camera = true; // so that no frame keeps the light of the one before
    return view;
  }
  bool lamps = false;

 private:
  float scale_;
  std::vector<InstanceView> instances_;
};

std::vector<Variant> variantsOf(const LaunchContext& stage) {
  Settings base = stage.settings;
  base.effects[EffectId::Indirect] = EffectMode::Off;
  base.effects[EffectId::Redraw] = EffectMode::On;
  base.shadow.emitters = EmitterShadows::Patches;
  std::vector<Variant> variants(4, {kOurs, base, stage.seed});
  Variant& paper = variants[1];
  paper.name = kPaper;
  paper.settings.area.refinement = AreaRefinement::SubFragments;
  paper.settings.area.threshold = 1;
  Variant& before = variants[2];
  before.name = kBefore;
  before.settings.area.threshold = 1;
  before.settings.area.refinement = AreaRefinement::Neighbours;
  before.settings.area.gradient = 0;
  before.settings.area.extra = false;
  before.settings.area.upsample = AreaUpsample::Bilinear;
  Variant& brute = variants[3];
  brute.name = kBrute;
  brute.settings.area.refinement = AreaRefinement::Neighbours; // asks all rays
  brute.settings.multires.depth = 0;                           // splits all
  return variants;
}

void addRows(const BenchOptions& options, const std::string& file, nlohmann::json& rows) {
  LaunchOptions launch = options.launch;
  launch.scene = file;
  if (launch.size.empty()) launch.size = "640x360";
  const auto stage = openLaunch(launch);
  GlContext context = GlContext::headless();
  for (const float scale : {1.0f, 0.25f}) {
    Progress progress("drawing", options.output.quiet);
    RunPlan plan = stillPlan(*stage, progress, Buffer::Direct);
    ScaledLamps lamps(scale);
    plan.view = [&, view = plan.view](int frame) { return lamps.of(view(frame)); };
    plan.frames = options.quick ? 2 : 6, plan.skip = 1;
    const std::vector<Measured> runs = measure(variantsOf(*stage), plan);
    if (runs[0].frames.back().areaFragments == 0)
      throw InputError(file, "no light of an emissive surface reaches this view (another scene or view)");
    const TracedPicture truth = tracePicture(plan.view(0), stage->settings,
                                             {.buffer = ReferenceBuffer::Direct,
                                              .samples = uint32_t(options.samples.value_or(options.quick ? 16 : 1024)),
                                              .seed = stage->seed,
                                              .cancelled = plan.cancelled});
    const double noise = expectedRelMse(truth.picture.mean, truth.picture.error);
    for (const Measured& m : runs) {
      const auto fragments = [](const FrameStats& s) { return double(s.areaFragments); };
      const double rays = m.ms(StageId::AreaRays).median, light = m.ms(StageId::AreaLight).median;
      rows.push_back({{"scene", fs::path(file).stem().string()},
                      {"lamp", scale == 1 ? "as it is" : "a quarter as wide"},
                      {"method", m.variant.name},
                      {"fragments", m.of(fragments).median},
                      {"visibility_ms", rays},
                      {"light_ms", light},
                      {"ms", rays + light},
                      {"rmse_share", pictureError(m.picture, truth.picture.mean).rmseShare()},
                      {"rel_mse", std::max(pictureError(m.picture, truth.picture.mean).relMse - noise, 0.0)}});
    }
    const nlohmann::json& before = rows[rows.size() - 2];
    for (size_t i = rows.size() - 4; i < rows.size() - 2; ++i)
      for (const char* what : {"fragments", "ms"})
        rows[i][std::string(what) + "_share"] = rows[i][what].get<double>() / before[what].get<double>();
  }
}

} // namespace

void benchArea(const BenchOptions& options) {
  if (!options.launch.technique.empty())
    throw InputError("--technique " + options.launch.technique, "cannot be chosen with --area, which measures its own");
  nlohmann::json rows;
  for (const std::string& file : options.scenes) addRows(options, file, rows);
  writeJson(options.output.json, {{"rows", rows}});
  if (options.output.quiet) return;
  std::printf("%s", tableText({{"scene", "scene"},
                               {"lamp", "lamp"},
                               {"method", "patches"},
                               {"fragments", "fragments", "%.0f"},
                               {"visibility_ms", "visibility, ms", "%.1f"},
                               {"light_ms", "light, ms", "%.1f"},
                               {"ms", "both, ms", "%.1f"},
                               {"rmse_share", "RMSE over mean", "%.2f %%", 100},
                               {"rel_mse", "relMSE less the truth's noise", "%.1e"},
                               {"fragments_share", "share of the predecessor's fragments", "%.2f"},
                               {"ms_share", "of its time", "%.2f"}},
                              rows)
                        .c_str());
}

} // namespace lambent
