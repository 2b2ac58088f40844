// Descriptors of lambent.h as what the engine has for them.
#pragma once

#include "engine/view/scene_view.h"
#include "gi/library/guard.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>

namespace lambent::library {

/// Checks a descriptor's size: that of a version so far, which is one. (A later one lets the sizes of older hosts pass,
/// and fills up what these do not know.)
template <class Desc> Desc read(const Desc* given, const char* what) {
  if (!given) refuse(std::string(what) + " is NULL");
  size_t size = 0;
  std::memcpy(&size, given, sizeof size);
  if (size != sizeof(Desc))
    refuse(std::string(what) + " has a size field of " + std::to_string(size) + " (LAMBENT_DEFAULTS sets it; " +
           std::to_string(sizeof(Desc)) + " in version " + lambent_version_text() + ")");
  return *given;
}

inline vec3 vec3Of(const float v[3]) { return {v[0], v[1], v[2]}; }
inline mat4 mat4Of(const float* m) {
  require(m != nullptr, "a matrix is NULL");
  mat4 out;
  for (int i = 0; i < 16; ++i) out[i / 4][i % 4] = m[i];
  return out;
}
inline void requireWithin(int value, int count, const char* what) {
  if (value < 0 || value >= count) refuse(std::string(what) + " is none of its values");
}

/// Light and sky as they are told. Where they stand, and other values, HostScene checks.
inline LightView lightOf(const lambent_light_desc* given) {
  const lambent_light_desc d = read(given, "light");
  requireWithin(d.type, 3, "light: type");
  LightView light;
  light.type = d.type == LAMBENT_LIGHT_POINT  ? LightType::Point
               : d.type == LAMBENT_LIGHT_SPOT ? LightType::Spot
                                              : LightType::Directional;
  light.position = vec3Of(d.position);
  light.direction = vec3Of(d.direction);
  light.intensity = vec3Of(d.intensity);
  light.range = d.range;
  require(d.inner_cone_angle >= 0 && d.outer_cone_angle >= d.inner_cone_angle && d.outer_cone_angle <= kPi,
          "light: cone angles are not 0 <= inner <= outer <= pi");
  light.innerConeCos = std::cos(d.inner_cone_angle);
  light.outerConeCos = std::cos(d.outer_cone_angle);
  light.angularRadius = d.angular_radius;
  return light;
}

inline Sky skyOf(const lambent_sky_desc* given) {
  const lambent_sky_desc d = read(given, "sky");
  requireWithin(d.type, 3, "sky: type");
  const vec3 radiance = vec3Of(d.radiance), sun = vec3Of(d.towards_sun);
  if (d.type == LAMBENT_SKY_CONSTANT) {
    require(isFinite(radiance) && std::min({radiance.x, radiance.y, radiance.z}) >= 0 && maxComponent(radiance) < 1e30f,
            "sky: radiance is below 0, or not finite");
    return Sky(radiance);
  }
  if (d.type == LAMBENT_SKY_PICTURE) {
    constexpr int kLongest = 4096;
    constexpr float kBrightest = 65504; // of half floats
    require(d.texels != nullptr, "sky: texels is NULL");
    require(std::min(d.width, d.height) >= 1 && std::max(d.width, d.height) <= kLongest,
            "sky: width or height is not 1 to 4096");
    require(d.scale >= 0 && d.scale <= 1e6f, "sky: scale is not 0 to 1e6");
    require(std::isfinite(d.turn), "sky: turn is not a number");
    auto image = std::make_shared<SkyImage>();
    image->width = d.width;
    image->height = d.height;
    for (size_t i = 0; i < size_t(d.width) * size_t(d.height); ++i) {
      const vec3 texel = vec3Of(d.texels + 3 * i);
      for (int c = 0; c < 3; ++c) require(texel[c] >= 0 && texel[c] <= kBrightest, "sky: a texel is not 0 to 65504");
      image->texels.push_back(texel);
    }
    return Sky::image(std::move(image), d.scale, d.turn);
  }
  const float length = glm::length(sun);
  require(length > 0 && std::isfinite(length), "sky: towards_sun has no length");
  require(std::isfinite(d.turbidity), "sky: turbidity is not a number");
  return Sky::daylight(sun / length, d.turbidity);
}

} // namespace lambent::library
