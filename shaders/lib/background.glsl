// The sky where no surface is seen. Variant DAYLIGHT: by direction; lib/gbuffer.glsl goes before, for its camera.
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
