// Radiance of a clear sky by direction, one text for C++ and GLSL: Preetham, Shirley, Smits 1999, "A practical analytic
// model for daylight". What does not depend on the direction is in the model (engine/view/sky.cpp).
#pragma once
#include "interop.h"
SHARED_BEGIN

struct DaylightModel {
  vec3 towardsSun;    // unit, not below the horizon
  vec3 zenith;        // chromaticity x, y and luminance Y there, over Perez's function there
  vec3 a, b, c, d, e; // Perez's coefficients of x, y and Y
  vec3 ground;        // radiance below the horizon
};

/// Perez's five-parameter function of the angles to the zenith and to the sun.
SHARED_INLINE vec3 perez(DaylightModel m, float cosZenith, float cosSun) {
  const vec3 one = vec3(1.0f, 1.0f, 1.0f);
  float angle = acos(clamp(cosSun, -1.0f, 1.0f));
  return (one + m.a * exp(m.b / max(cosZenith, 0.001f))) * (one + m.c * exp(m.d * angle) + m.e * (cosSun * cosSun));
}

/// Radiance from the unit direction d. The sun's disk is not in it.
SHARED_INLINE vec3 daylightRadiance(DaylightModel m, vec3 d) {
  if (d.y < 0.0f) return m.ground;
  vec3 xyY = m.zenith * perez(m, d.y, dot(d, m.towardsSun));
  float X = xyY.x / xyY.y * xyY.z, Y = xyY.z, Z = (1.0f - xyY.x - xyY.y) / xyY.y * xyY.z;
  // To linear Rec.709; colours outside of it are few, at dusk.
  return max(vec3(3.2406f * X - 1.5372f * Y - 0.4986f * Z, -0.9689f * X + 1.8758f * Y + 0.0415f * Z,
                  0.0557f * X - 0.2040f * Y + 1.0570f * Z),
             vec3(0.0f, 0.0f, 0.0f));
}

/// Where a picture of the sky (SkyImage) shows the unit direction d, turned by `turn` radians counter-clockwise as seen
/// from above: coordinates of a texture, from its first row on.
SHARED_INLINE vec2 skyImagePlace(vec3 d, float turn) {
  float around = (atan(d.z, d.x) + turn) * 0.159154943f + 0.5f;
  return vec2(around - floor(around), acos(clamp(d.y, -1.0f, 1.0f)) * 0.318309886f);
}

SHARED_END
