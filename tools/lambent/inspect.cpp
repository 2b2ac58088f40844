// lambent inspect SCENE: contents, size, lights; the effects it calls for, each with its reason; warnings. With
// --presets the presets, no scene.
#include "engine/core/error.h"
#include "gi/plan/effects.h"
#include "gi/plan/presets.h"
#include "gi/lighting/light_set.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/text.h"

#include <cstdio>

namespace lambent {

namespace {

const char* typeName(LightType t) {
  return t == LightType::Point ? "point" : t == LightType::Spot ? "spot" : "directional";
}

void inspect(const LaunchOptions& launch, const OutputOptions& output) {
  const auto stage = openLaunch(launch);
  const SceneView view = stage->at(0); // its spans hold until the next one
  const SceneAssets& assets = stage->scene.assets;
  uint64_t meshTriangles = 0, placedTriangles = 0;
  for (const Mesh& m : assets.meshes) meshTriangles += m.triangles.size();
  for (const InstanceView& i : view.instances) placedTriangles += assets.meshes[i.mesh].triangles.size();
  size_t skinned = 0, morphed = 0;
  stage->scene.registry.each<Skin, MeshInstance>([&](Entity, const Skin&, const MeshInstance&) { ++skinned; });
  stage->scene.registry.each<MorphWeights, MeshInstance>(
      [&](Entity, const MorphWeights&, const MeshInstance&) { ++morphed; });
  uint64_t texels = 0;
  for (const TextureImage& i : assets.images) texels += i.texels.size();
  const LightSet lights = collectLights(view);
  const vec3 size = view.boundsWorld.size();

  nlohmann::json j;
  j["file"] = stage->scene.file.string();
  j["triangles"] = placedTriangles;
  j["mesh_triangles"] = meshTriangles;
  j["meshes"] = assets.meshes.size();
  j["instances"] = view.instances.size();
  j["skinned_instances"] = skinned;
  j["morphed_instances"] = morphed;
  j["materials"] = assets.materials.size();
  j["images"] = assets.images.size();
  j["image_mib"] = double(texels) * 4 / (1 << 20);
  j["size_m"] = {size.x, size.y, size.z};
  j["animations"] = stage->scene.animations.size();
  j["lights"] = nlohmann::json::array();
  for (const LightView& l : view.lights) {
    const dvec3 position = stage->scene.origin + dvec3(l.position); // as --point takes it
    j["lights"].push_back({{"type", typeName(l.type)},
                           {"position", {position.x, position.y, position.z}},
                           {"direction", {l.direction.x, l.direction.y, l.direction.z}},
                           {"intensity", {l.intensity.x, l.intensity.y, l.intensity.z}}});
  }
  j["emitters"] = nlohmann::json::array();
  for (const Emitter& e : lights.emitters)
    j["emitters"].push_back(
        {{"triangles", e.triangleCount}, {"power_w_per_sr", e.power}, {"double_sided", e.doubleSided}});
  j["cameras"] = nlohmann::json::array();
  for (const NamedCamera& c : sceneCameras(stage->scene)) j["cameras"].push_back(c.name);
  j["effects"] = nlohmann::json::array();
  // Of a frame some time after the start, so that what moves by itself shows.
  const EffectPlan plan =
      planEffects(stage->at(1.0 / 30), stage->settings,
                  {.first = false,
                   .settingsChanged = false,
                   .drawingChanged = false,
                   .needs = needsOf(stage->settings),
                   .status = {.settled = true}});
  for (size_t i = 0; i < kEffects; ++i) {
    const Effect& e = plan[EffectId(i)];
    j["effects"].push_back({{"name", effectRow(EffectId(i)).name}, {"on", e.on}, {"reason", e.reason}});
  }
  j["warnings"] = stage->scene.warnings;
  j["notes"] = stage->notes;
  writeJson(output.json, j);
  if (output.quiet) return;

  std::printf("%s\n", stage->scene.file.c_str());
  std::printf("  triangles  %llu placed, %llu in %zu meshes, %zu instances\n", (unsigned long long)placedTriangles,
              (unsigned long long)meshTriangles, assets.meshes.size(), view.instances.size());
  if (skinned + morphed > 0) std::printf("  deformed   %zu skinned, %zu morphed instances\n", skinned, morphed);
  std::printf("  materials  %zu, %zu images (%.1f MiB)\n", assets.materials.size(), assets.images.size(),
              double(texels) * 4 / (1 << 20));
  std::printf("  size       %.3g x %.3g x %.3g m\n", double(size.x), double(size.y), double(size.z));
  std::printf("  animations %zu, cameras %zu\n", stage->scene.animations.size(), j["cameras"].size());
  for (const auto& l : j["lights"]) {
    const std::string type = l["type"];
    std::printf("  light      %s, %.3g %.3g %.3g %s\n", type.c_str(), l["intensity"][0].get<double>(),
                l["intensity"][1].get<double>(), l["intensity"][2].get<double>(),
                type == typeName(LightType::Directional) ? "W/m2" : "W/sr");
  }
  for (const Emitter& e : lights.emitters)
    std::printf("  emitter    %u triangles, %.3g W/sr%s\n", e.triangleCount, double(e.power),
                e.doubleSided ? " on each side" : "");
  std::printf("effects, with the VPLs settled\n");
  for (const auto& e : j["effects"])
    std::printf("  %-11s %-3s  %s\n", e["name"].get<std::string>().c_str(), e["on"].get<bool>() ? "on" : "off",
                printable(e["reason"].get<std::string>()).c_str());
  for (const std::string& w : stage->scene.warnings) std::printf("warning: %s\n", printable(w).c_str());
  for (const std::string& n : stage->notes) std::printf("note: %s\n", printable(n).c_str());
}

void inspectPresets(const OutputOptions& output) {
  nlohmann::json rows;
  for (const Preset& preset : presetTable()) {
    std::string set;
    for (const auto& [setting, value] : preset.set) set += (set.empty() ? "" : " ") + setting + "=" + value;
    rows.push_back({{"preset", preset.name}, {"set", set}, {"time", preset.time}, {"error", preset.error}});
  }
  writeJson(output.json, rows);
  if (output.quiet) return;
  std::printf("%s", tableText({{"preset", "preset"},
                               {"set", "sets"},
                               {"time", "time of a frame", "%.2f"},
                               {"error", "relMSE of indirect light", "%.2f"}},
                              rows)
                        .c_str());
  std::printf("of the default's, in hall, citadel and Cornell box together (docs/measurements/presets.md)\n");
}

} // namespace

void declareInspect(CLI::App& app) {
  auto launch = std::make_shared<LaunchOptions>();
  auto output = std::make_shared<OutputOptions>();
  auto presets = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("inspect", "what a scene holds and which effects it calls for");
  command->add_option("SCENE", launch->scene, "glTF or shot file");
  addLaunchOptions(*command, *launch);
  addOutputOptions(*command, *output, "");
  command->add_flag("--presets", *presets, "what the presets set, cost and bring, as measured; without SCENE");
  command->callback([launch, output, presets] {
    if (*presets) return inspectPresets(*output);
    if (launch->scene.empty()) throw InputError("inspect", "needs a scene or shot (or --presets)");
    inspect(*launch, *output);
  });
}

} // namespace lambent
