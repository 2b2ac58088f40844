#include "gi/measure/runs/sweeps.h"

#include "gi/plan/techniques.h"

#include <algorithm>
#include <set>

namespace lambent {

namespace {

std::string nameOf(const Assignments& set) {
  std::string name;
  for (const auto& [setting, value] : set) name += (name.empty() ? "" : " ") + setting + "=" + value;
  return name;
}

Settings settingsOf(const Assignments& set) {
  Settings settings;
  for (const auto& [setting, value] : set) applySetting(settings, setting, value);
  return settings;
}

const char* kDefault[] = {"default", "default, direct light"}; // by KnobLight

/// Lights and what each is worth: the more of them, the less a single one's map and paths matter. Lean, as by default,
/// rich, and rich with four times the near rays at every N; then other gathers, where these may pay.
std::vector<Assignments> jointDesign(bool quick) {
  struct Worth {
    const char *points, *paths, *resolution, *near;
  };
  static const Worth worths[] = {
      {"1024", "8", "64", "8"}, {"2048", "16", "128", "8"}, {"4096", "32", "128", "8"}, {"4096", "32", "128", "32"}};
  std::vector<Assignments> sets;
  for (const char* vpls : {"256", "512", "1024", "2048", "4096", "8192"})
    for (const Worth& w : worths) sets.push_back(worth(vpls, w.points, w.paths, w.resolution, w.near, "lists"));
  if (quick) return {sets.front()};
  for (const char* mode : {"multires-interleaved", "multires"})
    for (const char* vpls : {"512", "2048"}) sets.push_back(worth(vpls, "2048", "16", "128", "8", mode));
  return sets;
}

} // namespace

const std::vector<Knob>& knobTable() {
  using enum KnobLight;
  static const Assignments patches{{"gather.mode", "multires-interleaved"}};
  static const Assignments byLists{{"gather.mode", "lists"}};
  static const Assignments byPatches{{"shadow.emitters", "patches"}};
  static const Assignments byMaps{{"direct.soft", "maps"}};
  static const Assignments clamped{{"gather.disk", "0"}, {"gather.near", "0"}};
  static const std::vector<Knob> knobs{
      // The set of lights.
      {"smc.vpls", {"512", "1024", "2048", "4096", "8192"}},
      {"smc.moves", {"4", "16", "64"}},
      {"smc.candidateRays", {"4", "16", "64"}},
      {"smc.poolFrames", {"64", "16", "1"}},
      {"smc.paths", {"4", "8", "16", "32", "64"}},
      {"smc.bounces", {"1", "2", "3"}},
      {"smc.points", {"512", "2048", "8192"}},
      {"smc.validationRays", {"4", "16", "64"}},
      {"smc.warmup", {"25", "100", "400"}},
      {"smc.density", {"knn", "knn-side", "cells"}},
      {"smc.neighbours", {"1", "8", "32"}, Indirect, {{"smc.density", "knn-side"}}},
      // Who sees them.
      {"vpl.visibility", {"none", "maps", "rays"}},
      {"shadow.resolution", {"32", "64", "128", "256"}},
      {"shadow.refresh", {"12", "48", "192"}},
      {"shadow.motionRays", {"0", "4", "16", "64"}},
      {"gather.checks", {"off", "on"}},
      // Bounded energy, and how it is given back.
      {"gather.disk", {"0", "1", "4"}},
      {"gather.nearDisk", {"1", "2", "4", "8"}},
      {"gather.near", {"0", "2", "8", "32"}},
      {"gather.nearLimit", {"2", "8", "0"}},
      {"gather.clamp", {"1", "10", "0"}, Indirect, clamped},
      // Where light is gathered, and how it is put together.
      {"gather.mode", {"interleaved", "lists", "multires-interleaved", "multires", "full"}},
      {"gather.lights", {"24", "48", "96"}, Indirect, byLists},
      {"gather.tile", {"16", "8", "4"}, Indirect, byLists},
      {"filter.on", {"off", "on"}},
      {"filter.kernel", {"separable", "whole"}},
      {"filter.distance", {"0.0025", "0.01", "0.04"}},
      {"history.frames", {"0", "16", "64"}},
      {"multires.coarsest", {"8", "16", "64"}, Indirect, patches},
      {"multires.finest", {"4", "2", "1"}, Indirect, patches},
      {"multires.criterion", {"depth", "plane"}, Indirect, patches},
      {"multires.upsample", {"bilinear", "bilateral"}, Indirect, patches},
      {"multires.depth", {"0.1", "0.02", "0.005"}, Indirect, patches},
      {"multires.normal", {"0.7", "0.2", "0.05"}, Indirect, patches},
      {"multires.balance", {"off", "on"}, Indirect, patches},
      {"multires.edges", {"off", "on"}, Indirect, patches},
      // Direct light.
      {"shadow.rays", {"off", "on"}, Direct},
      {"direct.soft", {"maps", "rays"}, Direct},
      {"direct.surfaces", {"image", "rays"}, Direct},
      {"direct.samples", {"1", "2", "8"}, Direct},
      {"direct.mostSamples", {"2", "16", "64"}, Direct},
      {"direct.frames", {"0", "16", "64"}, Direct},
      {"shadow.emitterSamples", {"4", "16", "64"}, Direct, byMaps},
      {"shadow.emitterResolution", {"64", "256", "512"}, Direct, byMaps},
      {"shadow.emitters", {"samples", "patches"}, Direct, byMaps},
      {"area.refinement", {"counts", "sub-fragments", "neighbours"}, Direct, byPatches},
      {"area.rays", {"4", "8", "16", "64"}, Direct, byPatches},
      {"area.threshold", {"6", "4", "3", "2"}, Direct, byPatches},
      {"area.gradient", {"0", "4"}, Direct, byPatches},
      {"area.extra", {"off", "on"}, Direct, byPatches},
      {"area.upsample", {"bilinear", "bilateral", "rbf"}, Direct, byPatches},
      {"shadow.sunResolution", {"256", "512", "2048"}, Direct},
      {"shadow.pointResolution", {"64", "128", "512"}, Direct},
      {"shadow.skyMaps", {"8", "32", "128"}, Direct, byMaps},
      {"shadow.skyResolution", {"64", "256", "512"}, Direct, byMaps},
  };
  return knobs;
}

const std::vector<NoKnob>& noKnobTable() {
  static const std::vector<NoKnob> table{
      {{"vpl.source", "vpl.mirCandidates", "vpl.tcasIterations"}, "techniques are points of their own, as published"},
      {{"rsm.resolution", "rsm.vpls", "rsm.exact", "rsm.coarsest", "rsm.finest", "rsm.depth", "rsm.normal", "rsm.tau"},
       "of techniques from reflective shadow maps; their curves: --curve clusters"},
      {{"lpv.cells", "lpv.size", "lpv.steps", "lpv.occlusion", "lpv.lobes"},
       "of light propagation volumes; their table: --volume"},
      {{"cube.resolution", "cube.levels", "cube.split", "cube.visibility", "cube.hemicube"},
       "of the layered depth cube; their table: bench --cube"},
      {{"smc.cache", "shadow.maker", "area.tracer", "cube.maker", "frame.overlap"},
       "time alone: the picture is the same, or a frame late"},
      {{"shadow.bias", "filter.normalPower"}, "error alone: any value costs the same"},
      {{"shadow.firstMaps", "smc.shortWarmup"}, "of a first frame where rays are slow, as in none of these scenes"},
      {{"shadow.spotResolution"}, "as shadow.sunResolution, of lights that these scenes have not"},
      {{"multires.detail", "multires.light"}, "of splatting (technique multires-splat)"},
      {{"gather.glossy", "gather.mirrors", "gather.spread"}, "another picture: what is measured here is diffuse"},
      {{"direct.on"}, "whose light it is, an engine's choice"},
      {{"image.exposure", "image.adaptation", "image.toneMapper", "image.antiAliasing", "debug.nan", "debug.timing"},
       "how it is shown"},
      {{"effects.indirect", "effects.bounces", "effects.emissive", "effects.sky", "effects.alpha", "effects.textures",
        "effects.motion", "effects.mapRefresh", "effects.relight", "effects.replace", "effects.filter",
        "effects.history", "effects.glossy", "effects.mirrors", "effects.normalMaps", "effects.softShadows",
        "effects.gather", "effects.redraw"},
       "the plan leaves out only what shows nowhere"},
  };
  return table;
}

std::string knobPoint(const Knob& knob, const std::string& value) {
  Assignments set = knob.with;
  set.emplace_back(knob.setting, value);
  return settingsOf(set) == Settings{} ? kDefault[int(knob.light)] : nameOf(set);
}

std::string presetPoint(const Preset& preset) {
  return settingsOf(preset.set) == Settings{} ? kDefault[0] : nameOf(preset.set);
}

std::vector<SweepPoint> sweepPoints(SweepPart part) {
  const bool quick = part == SweepPart::Quick;
  using enum SweepPoint::Kind;
  std::vector<SweepPoint> points{{.name = kDefault[0]}, {.name = kDefault[1], .light = KnobLight::Direct}};
  std::set<std::string> known{kDefault[0], kDefault[1]};
  const auto add = [&](SweepPoint point) {
    if (known.insert(point.name).second) points.push_back(std::move(point));
  };
  for (const Knob& knob : knobTable()) {
    if (part == SweepPart::Joint) break;
    const std::string name = knob.setting;
    if (quick && name != "smc.vpls" && name != "direct.samples") continue;
    for (const char* value : knob.values) {
      if (quick && value != knob.values.front() && value != knob.values.back()) continue;
      Assignments set = knob.with;
      set.emplace_back(name, value);
      // A ray for every pair of pixel and light takes seconds.
      add({.name = knobPoint(knob, value),
           .kind = Alone,
           .set = set,
           .light = knob.light,
           .slow = value == std::string("rays")});
    }
  }
  for (const Assignments& set : jointDesign(quick))
    if (settingsOf(set) != Settings{}) add({.name = nameOf(set), .kind = Joint, .set = set});
  const auto cheapest =
      std::ranges::find_if(techniqueTable(), [](const Technique& t) { return needsOf(t).reflective(); });
  for (const Technique& technique : techniqueTable()) {
    if (&technique == &techniqueTable().front() || needsOf(technique).lights == LightSupply::None) continue;
    if (part == SweepPart::Joint || (quick && &technique != &*cheapest)) continue;
    add({.name = technique.name,
         .kind = Named,
         .technique = technique.name,
         .slow = needsOf(technique).lights == LightSupply::PerFrame}); // every map in every frame
  }
  return points;
}

} // namespace lambent
