// lambent inspect SCENE: contents, size, lights; the effects it calls for, each with its reason; warnings. With
// --presets the presets, no scene.
#include "engine/core/error.h"
#include "gi/lighting/light_set.h"
#include "gi/measure/scaled_view.h"
#include "gi/plan/effects.h"
#include "gi/plan/presets.h"
#include "tools/lambent/commands.h"

#include <cstdio>

namespace lambent {

namespace {

const char* typeName(LightType t) {
  return t == LightType::Point ? "point" : t == LightType::Spot ? "spot" : "directional";
}

Value listOf(const dvec3& v) { return std::vector{v.x, v.y, v.z}; }

void inspect(const LaunchOptions& launch, const OutputOptions& output) {
  const auto opened = openLaunch(launch);
  const SceneView view = opened->at(0); // its spans hold until the next one
  const SceneAssets& assets = opened->scene.assets;
  uint64_t meshTriangles = 0;
  for (const Mesh& m : assets.meshes) meshTriangles += m.triangles.size();
  const uint64_t placedTriangles = trianglesOf(view);
  size_t skinned = 0, morphed = 0;
  opened->scene.registry.each<Skin, MeshInstance>([&](Entity, const Skin&, const MeshInstance&) { ++skinned; });
  opened->scene.registry.each<MorphWeights, MeshInstance>(
      [&](Entity, const MorphWeights&, const MeshInstance&) { ++morphed; });
  uint64_t texels = 0;
  for (const TextureImage& i : assets.images) texels += i.texels.size();
  const LightSet lights = collectLights(view);
  const vec3 size = view.boundsWorld.size();

  Value j;
  j["file"] = opened->scene.file.string();
  j["triangles"] = placedTriangles;
  j["mesh_triangles"] = meshTriangles;
  j["meshes"] = assets.meshes.size();
  j["instances"] = view.instances.size();
  j["skinned_instances"] = skinned;
  j["morphed_instances"] = morphed;
  j["materials"] = assets.materials.size();
  j["images"] = assets.images.size();
  j["image_mib"] = double(texels) * 4 / (1 << 20);
  j["size_m"] = listOf(size);
  j["animations"] = opened->scene.animations.size();
  j["lights"] = Value::list();
  for (const LightView& l : view.lights) {
    const dvec3 position = opened->scene.origin + dvec3(l.position); // as --point takes it
    j["lights"].add(Value::of({{"type", typeName(l.type)},
                               {"position", listOf(position)},
                               {"direction", listOf(l.direction)},
                               {"intensity", listOf(l.intensity)}}));
  }
  j["emitters"] = Value::list();
  for (const Emitter& e : lights.emitters)
    j["emitters"].add(
        Value::of({{"triangles", e.triangleCount}, {"power_w_per_sr", e.power}, {"double_sided", e.doubleSided}}));
  j["cameras"] = Value::list();
  for (const NamedCamera& c : sceneCameras(opened->scene)) j["cameras"].add(c.name);
  j["effects"] = Value::list();
  // Of a frame some time after the start, so that what moves by itself shows.
  const EffectPlan plan =
      planEffects(opened->at(1.0 / 30), opened->settings,
                  {.first = false, .settingsChanged = false, .drawingChanged = false, .settled = true});
  for (size_t i = 0; i < kEffects; ++i) {
    const Effect& e = plan[EffectId(i)];
    j["effects"].add(Value::of({{"name", effectRow(EffectId(i)).name}, {"on", e.on}, {"reason", e.reason}}));
  }
  j["warnings"] = opened->scene.warnings;
  j["notes"] = opened->notes;
  writeJson(output.json, j);
  if (output.quiet) return;

  std::printf("%s\n", opened->scene.file.c_str());
  std::printf("  triangles  %llu placed, %llu in %zu meshes, %zu instances\n", (unsigned long long)placedTriangles,
              (unsigned long long)meshTriangles, assets.meshes.size(), view.instances.size());
  if (skinned + morphed > 0) std::printf("  deformed   %zu skinned, %zu morphed instances\n", skinned, morphed);
  std::printf("  materials  %zu, %zu images (%.1f MiB)\n", assets.materials.size(), assets.images.size(),
              double(texels) * 4 / (1 << 20));
  std::printf("  size       %.3g x %.3g x %.3g m\n", double(size.x), double(size.y), double(size.z));
  std::printf("  animations %zu, cameras %zu\n", opened->scene.animations.size(), j["cameras"].size());
  for (const LightView& l : view.lights)
    std::printf("  light      %s, %.3g %.3g %.3g %s\n", typeName(l.type), double(l.intensity.x), double(l.intensity.y),
                double(l.intensity.z), l.type == LightType::Directional ? "W/m2" : "W/sr");
  for (const Emitter& e : lights.emitters)
    std::printf("  emitter    %u triangles, %.3g W/sr%s\n", e.triangleCount, double(e.power),
                e.doubleSided ? " on each side" : "");
  std::printf("effects, with the VPLs settled\n");
  for (size_t i = 0; i < kEffects; ++i) {
    const Effect& e = plan[EffectId(i)];
    std::printf("  %-11s %-3s  %s\n", effectRow(EffectId(i)).name, e.on ? "on" : "off", printable(e.reason).c_str());
  }
  for (const std::string& w : opened->scene.warnings) std::printf("warning: %s\n", printable(w).c_str());
  for (const std::string& n : opened->notes) std::printf("note: %s\n", printable(n).c_str());
}

void inspectPresets(const OutputOptions& output) {
  Value rows;
  for (const Preset& preset : presetTable()) {
    std::string set;
    for (const auto& [setting, value] : preset.set) set += (set.empty() ? "" : " ") + setting + "=" + value;
    rows.add(Value::of({{"preset", preset.name}, {"set", set}, {"time", preset.time}, {"error", preset.error}}));
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
  Command command(app, "inspect", "what a scene holds and which effects it calls for");
  command.scene(launch->scene, "SCENE", "glTF or shot file", false);
  command.launch(*launch);
  command.output(*output, "");
  command.flag("--presets", *presets, "what the presets set, cost and bring, as measured; without SCENE");
  command.run([launch, output, presets] {
    if (*presets) return inspectPresets(*output);
    if (launch->scene.empty()) throw InputError("inspect", "needs a scene or shot (or --presets)");
    inspect(*launch, *output);
  });
}

} // namespace lambent
