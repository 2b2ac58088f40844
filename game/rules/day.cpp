#include "game/rules/day.h"

#include <cmath>

namespace lambent {

namespace {
constexpr double kHighest = 60.0 / 180 * 3.14159265358979323846; // radians, at noon
constexpr float kTurbidity = 3;
} // namespace

vec3 towardsSun(double hour) {
  const double around = (hour - 6) / 12 * 3.14159265358979323846; // 0 at sunrise
  return vec3(glm::normalize(
      dvec3(std::cos(around), std::sin(around) * std::sin(kHighest), std::sin(around) * std::cos(kHighest))));
}

void Day::set(std::optional<double> hour) {
  hour_ = hour;
  if (hour) return;
  for (const auto& [e, intensity] : dimmed_) scene_.registry.get<PunctualLight>(e).intensity = intensity;
  dimmed_.clear();
  if (sun_) scene_.registry.destroy(*sun_);
  sun_.reset();
  shown_.reset();
  scene_.sky = own_;
}

void Day::apply() {
  if (!hour_) return;
  Registry& registry = scene_.registry;
  registry.each<PunctualLight>([&](Entity e, PunctualLight& light) {
    if (light.type != LightType::Directional || e == sun_ || !(maxComponent(light.intensity) > 0)) return;
    bool known = false;
    for (const auto& [other, intensity] : dimmed_) known |= other == e;
    if (!known) dimmed_.emplace_back(e, light.intensity);
    light.intensity = vec3(0);
  });
  if (shown_ == hour_) return;
  shown_ = hour_;
  const vec3 up = towardsSun(*hour_);
  scene_.sky = Sky::daylight(up, kTurbidity);
  LightView sun;
  sun.type = LightType::Directional;
  sun.direction = -up;
  sun.intensity = daylightSun(up, kTurbidity);
  sun.angularRadius = kSunRadius;
  if (!sun_) sun_ = addLight(scene_, sun, "sun of the day");
  Transform& place = registry.get<Transform>(*sun_);
  place.rotation = rotationTowards(sun.direction);
  registry.get<WorldTransform>(*sun_).worldFromNode = place.local();
  registry.get<PunctualLight>(*sun_).intensity = sun.intensity;
}

} // namespace lambent
