// The time of day: a clear sky and its sun, in place of the scene's own.
#pragma once

#include "engine/scene/scene.h"

#include <optional>
#include <utility>
#include <vector>

namespace lambent {

/// Where the sun is at an hour of a day in spring, 0 to 24: it rises in the east (+X) at 6, is highest in the south
/// (+Z) at noon, 60 degrees up, and sets in the west. Unit.
vec3 towardsSun(double hour);

class Day {
 public:
  explicit Day(Scene& scene) : scene_(scene), own_(scene.sky) {}

  /// None: the scene's own light.
  void set(std::optional<double> hour);
  std::optional<double> hour() const { return hour_; }
  /// To be called after the scene was posed: a shot may have set its suns.
  void apply();

 private:
  Scene& scene_;
  const Sky own_;
  std::optional<double> hour_, shown_; // shown_: whose sky the scene has
  std::optional<Entity> sun_;
  std::vector<std::pair<Entity, vec3>> dimmed_; // the scene's suns, and what they had
};

} // namespace lambent
