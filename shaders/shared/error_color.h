// Error as a colour, ready for a display; one text for C++ and GLSL.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// `error`: 1 is the full colour, and more shows the same. None is black; too bright goes over red to yellow, too dark
/// over blue to cyan: whoever sees no red tells them apart by blue and yellow.
SHARED_INLINE vec3 errorColor(float error) {
  float strength = min(error < 0.0f ? -error : error, 1.0f);
  vec3 middle = error < 0.0f ? vec3(0.1f, 0.25f, 0.95f) : vec3(0.9f, 0.1f, 0.05f);
  vec3 full = error < 0.0f ? vec3(0.6f, 1.0f, 1.0f) : vec3(1.0f, 0.95f, 0.5f);
  return strength < 0.5f ? middle * (2.0f * strength) : mix(middle, full, 2.0f * strength - 1.0f);
}

SHARED_END
