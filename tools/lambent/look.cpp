// lambent render SCENE: one view → image. lambent inspect SCENE: contents, size, lights; the effects it calls for, each
// with its reason; warnings; with --presets the presets, no scene. lambent doctor: what this machine offers, and
// whether the whole pipeline runs on it.
#include "engine/core/error.h"
#include "engine/core/free_memory.h"
#include "engine/core/memory.h"
#include "engine/core/parallel.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "engine/trace/embree_query.h"
#include "gi/lighting/light_set.h"
#include "gi/measure/scaled_view.h"
#include "gi/plan/effects.h"
#include "gi/plan/presets.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/picture.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

namespace lambent {

namespace {

struct RenderOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::string buffer = "beauty";
  std::optional<int> frames; // none: as many as light is averaged over
  double time = 0;           // seconds
};

/// What brought the indirect light of a frame that was drawn.
std::string lightsText(const FrameStats& stats, const Settings& settings) {
  if (!stats.plan.on(EffectId::Indirect)) return "direct light only";
  const Needs needs = needsOf(settings);
  if (needs.tree) return "virtual lights in trees";
  if (needs.lights == LightSupply::None) return "no virtual lights";
  const std::string count = std::to_string(stats.vplsAlive);
  if (needs.lights == LightSupply::Fixed) return count + " samples of surfaces";
  return count + (needs.sampled() ? " of " + std::to_string(settings.smc.vpls) : "") + " virtual lights";
}

void render(const RenderOptions& options) {
  const Buffer buffer = bufferByName(options.buffer);
  const std::string& out = options.output.out;
  checkPictureName(out);
  const auto opened = openAndSay(options.launch, options.output.quiet, WatchUntil::FirstPicture);
  GlContext context = GlContext::headless();
  Viewer gi(opened->settings, opened->seed);
  std::optional<Progress> progress(std::in_place, "placing virtual lights", options.output.quiet);
  const auto begin = std::chrono::steady_clock::now();
  const FrameStats* stats = nullptr;
  FrameStats drawn; // of the last frame that was: once the lights have settled the picture stays
  int frames = options.frames.value_or(1);
  for (int i = 0; i < frames; ++i) {
    stats = &gi.run(opened->at(options.time), [&](int done, int total) {
      if (i == 0) progress->update(done, total);
      if (interrupted) throw RunError("interrupted");
    });
    if (i == 0) progress.emplace("drawing", options.output.quiet);
    sayWarning(*stats);
    if (stats->plan.on(EffectId::Redraw)) drawn = *stats;
    if (!options.frames && stats->plan.on(EffectId::History)) // from where all maps are whole
      frames = std::max(frames, opened->settings.history.frames + (stats->mapsWaiting > 0 ? i + 1 : 0));
    if (!options.frames && stats->raysSoft.occlusion > 0) frames = std::max(frames, opened->settings.direct.frames);
    progress->update(i + 1, frames);
  }
  progress.reset();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  writeBuffer(out, gi, buffer);
  Value figures = figuresOf(*stats);
  figures["exposure"] = gi.exposure();
  figures["picture"] = out;
  writeJson(options.output.json, figures);
  if (!options.output.quiet)
    std::printf("%s: %dx%d, %s, exposure %.3g, %d frame%s in %.1f s (the last drawn took %.1f ms)\n",
                printable(out).c_str(), opened->camera.width, opened->camera.height,
                lightsText(drawn, opened->settings).c_str(), double(gi.exposure()), frames, frames == 1 ? "" : "s",
                took.count(), drawn.wallMs);
}

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

  Value j =
      Value::of("file", opened->scene.file.string(), "triangles", placedTriangles, "mesh_triangles", meshTriangles,
                "meshes", assets.meshes.size(), "instances", view.instances.size(), "skinned_instances", skinned,
                "morphed_instances", morphed, "materials", assets.materials.size(), "images", assets.images.size(),
                "image_mib", double(texels) * 4 / (1 << 20), "size_m", listOf(size), "ray_work", view.rayWork,
                "animations", opened->scene.animations.size(), "warnings", opened->scene.warnings, "notes",
                opened->notes, "lights", Value::list(), "emitters", Value::list(), "cameras", Value::list());
  std::string lightLines;
  for (const LightView& l : view.lights) {
    lightLines += format("  light      %s, %.3g %.3g %.3g %s\n", typeName(l.type), l.intensity.x, l.intensity.y,
                         l.intensity.z, l.type == LightType::Directional ? "W/m2" : "W/sr");
    const dvec3 position = opened->scene.origin + dvec3(l.position); // as --point takes it
    j["lights"].add(Value::of("type", typeName(l.type), "position", listOf(position), "direction", listOf(l.direction),
                              "intensity", listOf(l.intensity)));
  }
  for (const Emitter& e : lights.emitters)
    j["emitters"].add(
        Value::of("triangles", e.triangleCount, "power_w_per_sr", e.power, "double_sided", e.doubleSided));
  for (const NamedCamera& c : sceneCameras(opened->scene)) j["cameras"].add(c.name);
  // Of a frame some time after the start, so that what moves by itself shows.
  const EffectPlan plan = planEffects(opened->at(1.0 / 30), opened->settings,
                                      {.first = false,
                                       .settingsChanged = false,
                                       .drawingChanged = false,
                                       .needs = needsOf(opened->settings),
                                       .status = {.settled = true}});
  std::string effectLines;
  for (size_t i = 0; i < kEffects; ++i) {
    const Effect& e = plan[EffectId(i)];
    const char* name = effectRow(EffectId(i)).name;
    j["effects"].add(Value::of("name", name, "on", e.on, "reason", e.reason));
    effectLines += format("  %-11s %-3s  ", name, e.on ? "on" : "off") + printable(e.reason) + "\n";
  }
  writeJson(output.json, j);
  if (output.quiet) return;

  std::printf("%s\n", printable(opened->scene.file.string()).c_str());
  std::printf("  triangles  %llu placed, %llu in %zu meshes, %zu instances\n", (unsigned long long)placedTriangles,
              (unsigned long long)meshTriangles, assets.meshes.size(), view.instances.size());
  if (skinned + morphed > 0) std::printf("  deformed   %zu skinned, %zu morphed instances\n", skinned, morphed);
  std::printf("  materials  %zu, %zu images (%.1f MiB)\n", assets.materials.size(), assets.images.size(),
              double(texels) * 4 / (1 << 20));
  std::printf("  size       %.3g x %.3g x %.3g m\n", double(size.x), double(size.y), double(size.z));
  std::printf("  rays       each looks at %.1f triangles in the mean\n", double(view.rayWork));
  std::printf("  animations %zu, cameras %zu\n", opened->scene.animations.size(), j["cameras"].size());
  std::printf("%s", lightLines.c_str());
  for (const Emitter& e : lights.emitters)
    std::printf("  emitter    %u triangles, %.3g W/sr%s\n", e.triangleCount, double(e.power),
                e.doubleSided ? " on each side" : "");
  std::printf("effects, with the VPLs settled\n%s", effectLines.c_str());
  for (const std::string& w : opened->scene.warnings) std::printf("warning: %s\n", printable(w).c_str());
  for (const std::string& n : opened->notes) std::printf("note: %s\n", printable(n).c_str());
}

void inspectPresets(const OutputOptions& output) {
  Value rows;
  for (const Preset& preset : presetTable()) {
    std::string set;
    for (const auto& [setting, value] : preset.set) set += (set.empty() ? "" : " ") + setting + "=" + value;
    rows.add(Value::of("preset", preset.name, "set", set, "time", preset.time, "error", preset.error));
  }
  writeJson(output.json, rows);
  if (output.quiet) return;
  std::printf("%s", tableText(std::vector<TableColumn>{{"preset", "preset"},
                                                       {"set", "sets"},
                                                       {"time", "time of a frame", "%.2f"},
                                                       {"error", "relMSE of indirect light", "%.2f"}},
                              rows)
                        .c_str());
  std::printf("of the default's, in hall, citadel and Cornell box together (docs/measurements/presets.md)\n");
}

std::string mebibytes(uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MiB", double(bytes) / (1 << 20));
  return text;
}

void doctor(const OutputOptions& output) {
  GlContext context = GlContext::headless();
  Value j;
  std::vector<std::pair<std::string, std::string>> rows = context.info();
  const std::vector<DeviceDescription> devices = GlContext::devices();
  for (size_t i = 0; i < devices.size(); ++i) rows.emplace_back("device " + std::to_string(i), devices[i].name);
  rows.emplace_back("embree", EmbreeQuery::version());
  rows.emplace_back("cores", std::to_string(std::thread::hardware_concurrency()) + " (" +
                                 std::to_string(threadCount()) + " used)");
  rows.emplace_back("bundled scenes", findContentFolder().string());

  LaunchOptions launch;
  launch.scene = (findContentFolder() / "cornell/cornell.gltf").string();
  launch.size = "64x64";
  if (!output.json.empty()) launch.written = {output.json};
  launch.set = {"smc.vpls=256", "smc.warmup=10"};
  const auto opened = openLaunch(launch);
  Viewer gi(opened->settings);
  gi.run(opened->at(0));
  const FrameStats stats = gi.run(opened->at(0));
  double indirect = 0;
  bool finite = true;
  const Image image = gi.read(Buffer::Indirect);
  for (const vec3& p : image.pixels) {
    indirect += luminance(p) / double(image.pixels.size());
    finite = finite && isFinite(p);
  }
  rows.emplace_back("shadow maps by", stats.shadowMaker);
  rows.emplace_back("GPU times by", stats.timing == "finish"
                                        ? "finishing each pass (timer queries lie here, or were not chosen)"
                                        : "timer queries");
  rows.emplace_back("memory left", mebibytes(freeMemory()));
  for (const auto& [name, value] : rows) j[name] = value;
  std::vector<Value> owners;
  std::string held;
  for (const MemoryAccount::Row& row : MemoryAccount::current().rows()) {
    owners.push_back(Value::of("owner", row.owner, "of", row.gpu ? "OpenGL" : "program", "bytes", row.bytes));
    held += (held.empty() ? "" : ", ") + row.owner + (row.gpu ? " (OpenGL) " : " ") + mebibytes(row.bytes);
  }
  j["memory held"] = owners;
  rows.emplace_back("held for the box", held);
  const bool healthy = finite && indirect > 0 && glDebugErrors() == 0;
  j["pipeline"] = healthy;
  writeJson(output.json, j);
  if (!output.quiet) {
    for (const auto& [name, value] : rows) std::printf("%-18s %s\n", name.c_str(), value.c_str());
    std::printf("%-18s %s (mean indirect radiance of a small Cornell box %.4f W/(m2 sr), frame %.0f ms)\n", "pipeline",
                healthy ? "runs" : "FAILS", indirect, stats.wallMs);
  }
  if (!healthy)
    throw RunError("the pipeline gave " + std::string(finite ? "no indirect light" : "values that are not finite") +
                   ", " + std::to_string(glDebugErrors()) + " OpenGL errors");
}

} // namespace

void declareRender(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  Command command(app, "render", "one view of a scene as a picture");
  command.reads("SCENE", options->launch.scene, "glTF or shot file", true);
  command.launch(options->launch);
  command.output(options->output, "picture, .png or linear .exr (default lambent.png)", "lambent.png");
  command.text("--buffer", options->buffer, bufferHelp(options->buffer, "draw"));
  command.number(
      "--frames", &options->frames, 1, 1000000,
      "frames up to the picture (default: as many as its light is averaged over: history.frames, direct.frames)");
  command.number("--time", &options->time, 0, 0, "seconds into the shot or the scene's animation, which stands there");
  command.run([options] { render(*options); });
}

void declareInspect(CLI::App& app) {
  auto launch = std::make_shared<LaunchOptions>();
  auto output = std::make_shared<OutputOptions>();
  auto presets = std::make_shared<bool>(false);
  Command command(app, "inspect", "what a scene holds and which effects it calls for");
  command.reads("SCENE", launch->scene, "glTF or shot file");
  command.launch(*launch);
  command.output(*output, "");
  command.flag("--presets", *presets, "what the presets set, cost and bring, as measured; without SCENE");
  command.run([launch, output, presets] {
    if (*presets) return inspectPresets(*output);
    if (launch->scene.empty()) throw InputError("inspect", "needs a scene or shot (or --presets)");
    inspect(*launch, *output);
  });
}

void declareDoctor(CLI::App& app) {
  auto output = std::make_shared<OutputOptions>();
  Command command(app, "doctor", "what this machine offers, and whether the pipeline runs on it");
  command.output(*output, "");
  command.run([output] { doctor(*output); });
}

} // namespace lambent
