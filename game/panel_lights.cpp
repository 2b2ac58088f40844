// The panel's sections about light: the time of day, and every lamp of the scene.
#include "game/hud.h"

#include <imgui/imgui.h>

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// How bright, apart from the colour: the largest channel.
void editIntensity(PunctualLight& light) {
  const float strength = std::max(maxComponent(light.intensity), 1e-6f);
  vec3 color = light.intensity / strength;
  float wanted = strength;
  const char* unit = light.type == LightType::Directional ? "W/m2" : "W/sr";
  const bool brighter = ImGui::SliderFloat(unit, &wanted, 1e-3f, 1e4f, "%.4g", ImGuiSliderFlags_Logarithmic);
  const bool other = ImGui::ColorEdit3("colour", &color.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs);
  if (brighter || other) light.intensity = std::max(wanted, 0.0f) * glm::max(color, vec3(0));
}

/// The way the light travels, as where it comes from: around from south to east, and above the horizon. Of a light that
/// hangs on something else, that moves it.
void editDirection(Scene& scene, Entity e) {
  WorldTransform& world = scene.registry.get<WorldTransform>(e);
  Transform& place = scene.registry.get<Transform>(e);
  if (scene.registry.has<Parent>(e) || place.matrix) return;
  const vec3 from = glm::normalize(vec3(world.worldFromNode[2])); // lights shine along -Z
  float around = glm::degrees(std::atan2(from.x, from.z));
  float above = glm::degrees(std::asin(glm::clamp(from.y, -1.0f, 1.0f)));
  bool turned = ImGui::SliderFloat("from, degrees (0 is +Z, 90 is +X)", &around, -180, 180, "%.0f");
  turned |= ImGui::SliderFloat("above, degrees", &above, -89, 89, "%.0f");
  if (!turned) return;
  const float a = glm::radians(around), h = glm::radians(above);
  place.rotation = rotationTowards(-vec3(std::sin(a) * std::cos(h), std::sin(h), std::cos(a) * std::cos(h)));
  world.worldFromNode = place.local();
}

} // namespace

void Hud::drawDay(HudModel& model) {
  bool on = model.hour.has_value();
  if (ImGui::Checkbox("a clear sky and its sun", &on)) model.hour = on ? std::optional(12.0) : std::nullopt;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("in place of the scene's own sky and suns; lamps stay");
  if (!model.hour) {
    ImGui::TextDisabled("T lets a day go by");
    return;
  }
  float hour = float(*model.hour);
  if (ImGui::SliderFloat("hour", &hour, 0, 23.99f, "%.2f")) model.hour = double(hour);
  ImGui::Checkbox("goes by: a day in 96 s (T)", &model.dayRuns);
}

void Hud::drawLights(Scene& scene) {
  bool any = false;
  scene.registry.each<PunctualLight>([&](Entity e, PunctualLight& light) {
    const Name* name = scene.registry.tryGet<Name>(e);
    const char* kind = light.type == LightType::Directional ? "sun"
                       : light.type == LightType::Spot      ? "spotlight"
                                                            : "lamp";
    ImGui::PushID(int(e.id()));
    if (ImGui::TreeNode("light", "%s (%s)", name ? name->value.c_str() : "unnamed", kind)) {
      editIntensity(light);
      if (light.type != LightType::Point) editDirection(scene, e);
      ImGui::TreePop();
    }
    ImGui::PopID();
    any = true;
  });
  int glowing = 0;
  for (const Material& material : scene.assets.materials) glowing += material.emits();
  if (!any) ImGui::TextDisabled("no lamps (L gives you one)");
  if (glowing > 0) ImGui::TextDisabled("and %d glowing material%s", glowing, glowing == 1 ? "" : "s");
}

} // namespace lambent
