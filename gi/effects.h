// Which effects the scene and this frame call for, each with its reason in plain words. A pure function of the view.
#pragma once

#include "engine/scene/scene_view.h"
#include "gi/settings.h"

#include <string>
#include <vector>

namespace lambent {

struct Effect {
  std::string name;
  bool on = false;
  std::string reason;
};

struct EffectPlan {
  bool indirect = false;       // VPLs, their maps and the gather
  bool moreBounces = false;    // light paths beyond the first vertex
  bool punctualLights = false; // point, spot and directional lights
  bool emissiveSurfaces = false;
  bool sky = false;
  bool alphaTest = false;
  bool textures = false;
  bool filter = false;

  std::vector<Effect> effects; // the same, for people

  std::string oneLine() const; // names of the effects that are on, separated by '+'
};

EffectPlan planEffects(const SceneView& view, const Settings& settings);

} // namespace lambent
