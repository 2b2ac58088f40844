#include "gi/plan/effects.h"

#include "shaders/shared/ggx.h"

#include <cmath>
#include <utility>

namespace lambent {

namespace {

constexpr EffectRow kRows[kEffects] = {
    {"indirect", "light reflected by surfaces: VPLs, their shadow maps, the gather", "rays and draws"},
    {"bounces", "light paths beyond the first surface that reflects; off: one bounce", "rays"},
    {"emissive", "light from emissive surfaces; off: they glow and light nothing", "shadow maps and rays"},
    {"sky", "light from the sky; off: it is seen and lights nothing", "shadow maps and rays"},
    {"alpha", "cut-out and blended materials let light through", "tests and draws"},
    {"textures", "light takes the colour of the texel it meets; off: the texture's mean", "lookups"},
    {"motion", "objects move; off: they stay where they were when it was switched off", "objects placed"},
    {"mapRefresh", "shadow maps of VPLs follow objects that move", "maps and rays"},
    {"relight", "VPLs follow lights and geometry that change", "VPLs"},
    {"replace", "VPLs are tested and replaced; off: the first set stays", "rays"},
    {"filter", "mixes the 4x4 subsets of a gather", "draws"},
    {"history", "indirect light of a pixel is averaged over frames; off: each by itself", "draws"},
    {"glossy", "reflection by roughness and metalness where the camera looks; off: Lambert", "draws"},
    {"mirrors", "rays for what smooth surfaces mirror; off: VPLs, as by roughness 0.3", "rays"},
    {"normalMaps", "normal maps where the camera looks; off: surfaces are as smooth as their meshes", "draws"},
    {"softShadows", "emissive surfaces are many samples in direct light; off: one each", "samples"},
    {"gather", "light of VPLs is brought to surfaces; off: what a cube holds stays, and else there is none", "draws"},
    {"redraw", "the frame is drawn again; off: the last one stays", "draws"},
};

std::string count(size_t n, const char* what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

bool reflects(const Material& m) { return maxComponent(m.baseColor) > 0; }

/// Whether light that one surface reflects can reach another that reflects. Certain only where it says no: everything
/// that is not black lies in one plane. Large scenes are not asked. With `glossy` black surfaces count whose lobe
/// reflects.
bool reflectorsSeeOneAnother(const SceneView& view, bool glossy) {
  constexpr uint32_t kAsked = 4096;                                                        // triangles
  const double tolerance = 0x1p-21 * std::max(1e-20, double(view.boundsWorld.diameter())); // some steps of floats
  uint32_t triangles = 0;
  dvec3 origin(0), normal(0);
  for (const InstanceView& i : view.instances) {
    const Mesh& mesh = view.assets->meshes[i.mesh];
    for (const Primitive& p : mesh.primitives) {
      const Material& material = view.assets->materials[p.material];
      if (!(reflects(material) || (glossy && material.glossy())) || p.triangleCount == 0) continue;
      triangles += p.triangleCount;
      if (triangles > kAsked || i.deformed) return true;
      for (uint32_t t = 0; t < p.triangleCount; ++t) {
        const uvec3 corners = mesh.triangles[p.firstTriangle + t];
        dvec3 at[3];
        for (int c = 0; c < 3; ++c) at[c] = dvec3(dmat4(i.worldFromObject) * glm::dvec4(mesh.positions[corners[c]], 1));
        if (normal == dvec3(0)) {
          const dvec3 n = glm::cross(at[1] - at[0], at[2] - at[0]);
          if (!(glm::length(n) > 0)) return true;
          normal = glm::normalize(n);
          origin = at[0];
        }
        for (const dvec3& corner : at)
          if (!(std::abs(glm::dot(corner - origin, normal)) <= tolerance)) return true;
      }
    }
  }
  return false;
}

/// What the scene's lights, materials and instances hold.
struct SceneFacts {
  size_t punctual = 0, emissive = 0, masked = 0, textured = 0, reflecting = 0, glossy = 0, smooth = 0, normalMaps = 0,
         moved = 0;
  bool emittersMoved = false;

  explicit SceneFacts(const SceneView& view) {
    for (const LightView& l : view.lights) punctual += luminance(l.intensity) > 0;
    for (const InstanceView& i : view.instances) {
      moved += i.moved;
      for (const Primitive& p : view.assets->meshes[i.mesh].primitives) {
        const Material& m = view.assets->materials[p.material];
        emissive += m.emits();
        emittersMoved |= m.emits() && i.moved;
        masked += m.alphaMode != AlphaMode::Opaque;
        textured += m.baseColorTexture.image != kNone;
        reflecting += reflects(m);
        glossy += m.glossy();
        smooth += mirrors(*view.assets, m);
        normalMaps += m.normalTexture.image != kNone;
      }
    }
  }
};

using Answer = std::pair<bool, std::string>;

} // namespace

bool mirrors(const SceneAssets& assets, const Material& material) {
  const bool lobe = material.metalness > 0 || material.dielectricLobe > 0;
  return lobe && leastRoughness(assets, material) < kLeastVplRoughness + 0.05f; // mirrorShare
}

const EffectRow& effectRow(EffectId id) { return kRows[size_t(id)]; }

EffectPlan planEffects(const SceneView& view, const Settings& settings, const FrameFacts& facts) {
  const SceneFacts scene(view);
  const bool seeOneAnother = reflectorsSeeOneAnother(view, settings.gather.glossy);
  const SceneChanges& changes = view.changes;
  const SmcSettings& smc = settings.smc;
  EffectPlan plan;
  const auto decide = [&](EffectId id, Answer answer) {
    Effect& e = plan.effects_[size_t(id)];
    const EffectMode mode = settings.effects[id];
    e.forced = mode != EffectMode::Auto;
    e.calledFor = answer.first;
    e.on = e.forced ? mode == EffectMode::On : answer.first;
    e.reason = e.forced ? std::string("effects.") + effectRow(id).name + " is " + (e.on ? "on" : "off")
                        : std::move(answer.second);
    return e.on;
  };
  const Needs& needs = facts.needs;
  const ProviderStatus& status = facts.status;
  const bool reflective = needs.lights == LightSupply::Reflective;
  const auto whyNoIndirect = [&](bool light) -> Answer {
    if (smc.bounces < 1) return {false, "smc.bounces is 0"};
    if (reflective && scene.punctual == 0) return {false, "no punctual light, so no reflective shadow map"};
    if (view.instances.empty()) return {false, "nothing to light"};
    if (!light) return {false, "no light"};
    if (scene.reflecting == 0) return {false, "every surface is black"};
    if (!seeOneAnother) return {false, "all that reflects lies in one plane"};
    return {true, "light, and surfaces that reflect it to one another"};
  };

  // What the scene holds.
  const bool emissive =
      decide(EffectId::Emissive, {scene.emissive > 0, scene.emissive > 0 ? count(scene.emissive, "emissive surface")
                                                                         : "no material emits"});
  const bool sky = !view.sky.black();
  const bool skyLight = decide(EffectId::Sky, {sky, sky ? "the sky has radiance" : "the sky is black"});
  decide(EffectId::Alpha, {scene.masked > 0, scene.masked > 0 ? count(scene.masked, "alpha-masked or blended surface")
                                                              : "no material has an alpha mask or blends"});
  const bool anyLight = scene.punctual > 0 || (emissive && scene.emissive > 0) || (skyLight && sky);
  const bool indirect = decide(EffectId::Indirect, whyNoIndirect(anyLight));
  const bool lights = indirect && needs.lights != LightSupply::None;
  const Answer none{false, indirect ? "the technique has no virtual lights" : "no indirect light"};
  const Answer oneBounce{false,
                         reflective ? "reflective shadow maps show one bounce" : "the technique shows one bounce"};
  decide(EffectId::Bounces, !indirect         ? none
                            : !needs.bounces  ? oneBounce
                            : smc.bounces < 2 ? Answer{false, "smc.bounces is " + std::to_string(smc.bounces)}
                            : !seeOneAnother  ? Answer{false, "all that reflects lies in one plane"}
                                              : Answer{true, "smc.bounces is " + std::to_string(smc.bounces)});
  decide(EffectId::Textures, !indirect            ? none
                             : !needs.textures    ? Answer{false, "the technique traces no light path"}
                             : scene.textured > 0 ? Answer{true, count(scene.textured, "textured surface")}
                                                  : Answer{false, "no base-colour texture"});
  decide(EffectId::SoftShadows, !emissive || scene.emissive == 0 ? Answer{false, "no emissive surface"}
                                : settings.shadow.emitterSamples > 1 ||
                                        settings.shadow.emitters == EmitterShadows::Patches ||
                                        settings.direct.soft == SoftLightBy::Rays
                                    ? Answer{true, count(scene.emissive, "lamp")}
                                    : Answer{false, "shadow.emitterSamples is 1"});
  decide(EffectId::Filter, !lights               ? none
                           : !needs.subsets      ? Answer{false, "every pixel sees all VPLs"}
                           : !settings.filter.on ? Answer{false, "filter.on is off"}
                                                 : Answer{true, "pixels of 4x4 gather different lights"});

  const bool bounded =
      needs.nearRays && settings.gather.near > 0 && (settings.gather.disk > 0 || settings.gather.clamp > 0);
  decide(EffectId::History, !lights                       ? none
                            : settings.history.frames < 2 ? Answer{false, "history.frames is less than 2"}
                            : needs.subsets               ? Answer{true, "pixels of 4x4 gather different lights"}
                            : bounded                     ? Answer{true, "near light is traced"}
                                                          : Answer{false, "every frame gathers the same light"});
  decide(EffectId::Glossy, !settings.gather.glossy ? Answer{false, "gather.glossy is off"}
                           : scene.glossy > 0      ? Answer{true, count(scene.glossy, "glossy surface")}
                                                   : Answer{false, "every material has roughness 1 and no metalness"});
  decide(EffectId::Mirrors, !indirect                      ? Answer{false, "no indirect light"}
                            : !plan.on(EffectId::Glossy)   ? Answer{false, "surfaces are Lambert"}
                            : settings.gather.mirrors == 0 ? Answer{false, "gather.mirrors is 0"}
                            : scene.smooth > 0             ? Answer{true, count(scene.smooth, "smooth surface")}
                                                           : Answer{false, "no material is smoother than 0.35"});
  decide(EffectId::NormalMaps,
         {scene.normalMaps > 0, scene.normalMaps > 0 ? count(scene.normalMaps, "surface") + " with normal maps"
                                                     : "no material has a normal map"});

  // What changed.
  const bool geometry = changes.geometry || changes.instances;
  const std::string movers = !geometry         ? "nothing moved"
                             : scene.moved > 0 ? count(scene.moved, "object") + " moved"
                                               : "objects came or went";
  const bool motion =
      decide(EffectId::Motion, changes.first ? Answer{true, "the scene is new"} : Answer{geometry, movers});
  const bool moved = geometry && motion;
  decide(EffectId::MapRefresh, !lights                  ? none
                               : reflective             ? Answer{false, "maps are drawn with the VPLs"}
                               : moved                  ? Answer{true, movers}
                               : status.mapsWaiting > 0 ? Answer{true, count(status.mapsWaiting, "map") + " waiting"}
                                                        : Answer{false, "nothing moved"});
  const bool sameLight = !changes.first && !changes.lights && !moved && !facts.settingsChanged;
  // By photons or chains; photons take the same ways as long as nothing is in another place.
  const bool sameWays = needs.anyView && sameLight;
  const bool perFrame = needs.lights == LightSupply::PerFrame;
  const Answer fromMaps{false, "VPLs come from the reflective shadow maps"};
  const bool still = !changes.first && !changes.camera && !changes.lights && !moved && !facts.settingsChanged;
  decide(EffectId::Relight, !lights                 ? none
                            : reflective            ? fromMaps
                            : perFrame && sameWays  ? Answer{false, "photons take the same ways as before"}
                            : perFrame              ? Answer{true, "the technique lights its VPLs again in every frame"}
                            : changes.first         ? Answer{true, "the scene is new"}
                            : changes.lights        ? Answer{true, "lights changed"}
                            : moved                 ? Answer{true, movers}
                            : facts.settingsChanged ? Answer{true, "settings changed"}
                            : !smc.cache && !(still && status.settled)
                                ? Answer{true, "smc.cache is off: every light path is traced in every frame"}
                                : Answer{false, "neither lights nor objects changed"});
  decide(EffectId::Replace, !lights                              ? none
                            : needs.lights == LightSupply::Fixed ? Answer{false, "the samples stay on their surfaces"}
                            : reflective                         ? fromMaps
                            : perFrame && sameWays               ? Answer{false, "photons take the same ways as before"}
                            : perFrame ? Answer{true, "the technique places its VPLs again in every frame"}
                            : still && status.settled ? Answer{false, "nothing changed and the VPLs have settled"}
                            : still                   ? Answer{true, "the VPLs have not settled yet"}
                                                      : Answer{true, "the view or the scene changed"});
  decide(EffectId::Gather, !indirect      ? Answer{false, "no indirect light"}
                           : needs.stored ? sameLight && !facts.drawingChanged && !status.lightArrived
                                                ? Answer{false, "the cube holds the light of what there is"}
                                                : Answer{true, "the cube follows lights and objects"}
                                          : Answer{true, "every frame gathers its light"});
  const bool averages = plan.on(EffectId::History) && plan.calledFor(EffectId::History);
  const int historyFrames = averages ? settings.history.frames : 0;
  const Effect& replace = plan[EffectId::Replace];
  const bool newLight = indirect && ((replace.on && replace.calledFor) || status.lightArrived);
  const bool waiting = indirect && status.mapsWaiting > 0;
  plan.lightChanges_ = changes.first || changes.lights || moved || facts.settingsChanged || waiting;
  plan.seenChanges_ = !still || facts.drawingChanged || facts.first;
  plan.changed_ = !still || facts.drawingChanged || newLight || waiting;
  const bool mirrorsPending = facts.mirrorsPending && plan.on(EffectId::Mirrors);
  decide(EffectId::Redraw, !still                 ? Answer{true, "the view, the scene or settings changed"}
                           : facts.drawingChanged ? Answer{true, "settings or shaders changed"}
                           : newLight             ? Answer{true, "VPLs change"}
                           : waiting              ? Answer{true, "shadow maps are waiting"}
                           : indirect && !status.pending.empty() ? Answer{true, status.pending}
                           : status.averaged < historyFrames     ? Answer{true, "light is averaged over frames"}
                           : mirrorsPending                      ? Answer{true, "reflections are averaged over frames"}
                           : facts.directPending                 ? Answer{true, "direct light is averaged over frames"}
                                                                 : Answer{false, "nothing changed"});
  plan.onlyDirect_ = facts.directPending && !mirrorsPending && !facts.first && !plan.changed_ &&
                     status.averaged >= historyFrames && !(indirect && !status.pending.empty());
  if (Effect& redraw = plan.effects_[size_t(EffectId::Redraw)]; facts.first && !redraw.on) {
    redraw.on = true;
    redraw.reason = "there is no frame yet";
  }
  return plan;
}

std::string EffectPlan::oneLine() const {
  std::string line;
  for (size_t i = 0; i < kEffects; ++i)
    if (effects_[i].on) line += (line.empty() ? "" : "+") + std::string(effectRow(EffectId(i)).name);
  return line.empty() ? "none" : line;
}

} // namespace lambent
