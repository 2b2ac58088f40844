// Depth, and the sky where no surface is seen. Variants DAYLIGHT (by direction) and GLOSSY: with all of lib/gbuffer.glsl.
#if defined(GLOSSY) || defined(DAYLIGHT)
#include "gbuffer.glsl"
#else
layout(binding = 0) uniform sampler2D gbufferDepth;
#endif
#ifdef DAYLIGHT
#include "shared/sky.h"
uniform DaylightModel daylight;

vec3 backgroundAt(ivec2 pixel) {
  vec3 direction = mat3(camera.worldFromView) * viewDirectionFromPixel(camera, vec2(pixel) + 0.5);
  return daylightRadiance(daylight, normalize(direction));
}
#else
uniform vec3 skyRadiance;

vec3 backgroundAt(ivec2 pixel) { return skyRadiance; }
#endif
