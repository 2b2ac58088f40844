// Depth, and the sky where no surface is seen. Variants DAYLIGHT (by direction), SKY_IMAGE (a picture, with
// DAYLIGHT) and GLOSSY: with all of lib/gbuffer.glsl.
#if defined(GLOSSY) || defined(DAYLIGHT)
#include "gbuffer.glsl"
#else
layout(binding = 0) uniform sampler2D gbufferDepth;
#endif
#ifdef DAYLIGHT
#include "shared/sky.h"
#ifdef SKY_IMAGE
layout(binding = 11) uniform sampler2D skyImage; // SkyImage
uniform vec2 skyScaleTurn;

vec3 skyTexel(ivec2 at) {
  ivec2 size = textureSize(skyImage, 0);
  return texelFetch(skyImage, ivec2((at.x + size.x) % size.x, clamp(at.y, 0, size.y - 1)), 0).rgb;
}
/// Linear, and on around the seam, which a sampler of one wrap mode does not do.
vec3 skyBetweenTexels(vec2 place) {
  vec2 at = place * vec2(textureSize(skyImage, 0)) - 0.5, low = floor(at), part = at - low;
  ivec2 first = ivec2(low);
  return mix(mix(skyTexel(first), skyTexel(first + ivec2(1, 0)), part.x),
             mix(skyTexel(first + ivec2(0, 1)), skyTexel(first + ivec2(1, 1)), part.x), part.y);
}
#else
uniform DaylightModel daylight;
#endif

vec3 backgroundAt(ivec2 pixel) {
  vec3 direction = mat3(camera.worldFromView) * viewDirectionFromPixel(camera, vec2(pixel) + 0.5);
#ifdef SKY_IMAGE
  return skyScaleTurn.x * skyBetweenTexels(skyImagePlace(normalize(direction), skyScaleTurn.y));
#else
  return daylightRadiance(daylight, normalize(direction));
#endif
}
#else
uniform vec3 skyRadiance;

vec3 backgroundAt(ivec2 pixel) { return skyRadiance; }
#endif
