#include "gi/contract/light_views.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lambent {

LightKind kindOf(const LightView& light) {
  constexpr float kWidestSpotCos = 0.34f; // 70°
  if (light.type == LightType::Directional) return LightKind::Sun;
  return light.type == LightType::Spot && light.outerConeCos > kWidestSpotCos ? LightKind::Spot : LightKind::Cube;
}

bool shines(const LightView& light) { return maxComponent(light.intensity) > 0 && isFinite(light.intensity); }

float nearPlane(const Aabb& bounds) { return std::max(1e-20f, 1e-4f * bounds.diameter()); }

vec2 coneFactors(const LightView& light) {
  if (light.type != LightType::Spot) return {0, 1};
  const float scale = 1 / std::max(0.001f, light.innerConeCos - light.outerConeCos);
  return {scale, -light.outerConeCos * scale};
}

float inverseRange4(const LightView& light) {
  const double range2 = double(light.range) * double(light.range); // of a short range 1/range⁴ is beyond a float
  return range2 > 0 ? float(std::min(1 / (range2 * range2), double(std::numeric_limits<float>::max()))) : 0;
}

} // namespace lambent
