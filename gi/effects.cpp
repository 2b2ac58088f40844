#include "gi/effects.h"

namespace lambent {

namespace {

/// What the scene's materials and instances hold.
struct SceneFacts {
  uint32_t emissive = 0, masked = 0, textured = 0, moving = 0;
};

SceneFacts gather(const SceneView& view) {
  SceneFacts f;
  for (const InstanceView& i : view.instances) {
    f.moving += i.moved;
    for (const Primitive& p : view.assets->meshes[i.mesh].primitives) {
      const Material& m = view.assets->materials[p.material];
      f.emissive += m.emits();
      f.masked += m.alphaMode == AlphaMode::Mask;
      f.textured += m.baseColorTexture.image != kNone;
    }
  }
  return f;
}

std::string count(size_t n, const char* what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

} // namespace

EffectPlan planEffects(const SceneView& view, const Settings& settings) {
  const SceneFacts facts = gather(view);
  EffectPlan plan;
  const auto decide = [&](bool& flag, const char* name, bool on, std::string reason) {
    flag = on;
    plan.effects.push_back({name, on, std::move(reason)});
  };
  size_t punctual = 0;
  for (const LightView& l : view.lights) punctual += luminance(l.intensity) > 0;
  decide(plan.punctualLights, "punctual", punctual > 0,
         punctual ? count(punctual, "point, spot or directional light") : "no punctual light with power");
  decide(plan.emissiveSurfaces, "emissive", facts.emissive > 0,
         facts.emissive ? count(facts.emissive, "emissive surface") : "no material emits");
  const bool sky = luminance(view.skyRadiance) > 0;
  decide(plan.sky, "sky", sky, sky ? "the sky has radiance" : "the sky is black");
  const bool anyLight = plan.punctualLights || plan.emissiveSurfaces || plan.sky;
  const bool indirect = anyLight && settings.smc.bounces > 0 && !view.instances.empty();
  decide(plan.indirect, "indirect", indirect,
         indirect                    ? "light and surfaces that reflect it"
         : settings.smc.bounces == 0 ? "smc.bounces is 0"
         : view.instances.empty()    ? "nothing to light"
                                     : "no light");
  decide(plan.moreBounces, "bounces", indirect && settings.smc.bounces > 1,
         "smc.bounces is " + std::to_string(settings.smc.bounces));
  decide(plan.alphaTest, "alpha", facts.masked > 0,
         facts.masked ? count(facts.masked, "alpha-masked surface") : "no alpha mask");
  decide(plan.textures, "textures", facts.textured > 0,
         facts.textured ? count(facts.textured, "textured surface") : "no base-colour texture");
  const bool interleaved =
      indirect && settings.gather.mode == GatherMode::Interleaved && settings.smc.visibility == VplVisibility::Maps;
  decide(plan.filter, "filter", interleaved && settings.filter.on,
         interleaved ? (settings.filter.on ? "interleaved gathering needs it" : "filter.on is off")
                     : "no interleaved gathering");
  return plan;
}

std::string EffectPlan::oneLine() const {
  std::string line;
  for (const Effect& e : effects)
    if (e.on) line += (line.empty() ? "" : "+") + e.name;
  return line.empty() ? "none" : line;
}

} // namespace lambent
