#version 450
// What history.frag found where light changes: its coarse part follows the filtered difference to this frame by `follow`,
// its fine part is averaged on. Glossy light is this
// frame's own. Variants: SUBSETS, GLOSSY.
#include "lib/gbuffer.glsl"
#include "lib/subsets.glsl"
#include "shared/octahedral.h"

layout(binding = 2) uniform sampler2D kept;     // a: frames in the mean
layout(binding = 3) uniform sampler2D change;   // this frame - kept
layout(binding = 4) uniform sampler2D filtered; // of change
layout(binding = 6) uniform sampler2D shares;   // history_tiles.frag
uniform float follow;
layout(location = 0) out vec4 outIrradiance;
layout(location = 1) out vec4 outSeen;
#ifdef GLOSSY
layout(binding = 5) uniform sampler2D glossy; // of this frame
layout(location = 2) out vec4 outGlossy;
#endif

const float kNoise = 0.15, kCertain = 0.4; // changes of a tile: from here on it forgets, here wholly

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = outSeen = vec4(0.0);
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec4 before = texelFetch(kept, pixel, 0), difference = texelFetch(change, pixel, 0);
  float share = texture(shares, gl_FragCoord.xy / (16.0 * vec2(textureSize(shares, 0)))).r;
  float stays = 1.0 - smoothstep(kNoise, kCertain, share), count = before.a * stays;
  vec3 brought = max(before.rgb + follow * texelFetch(filtered, pixel, 0).rgb, 0.0);
  outIrradiance = vec4(mix(brought, before.rgb + difference.rgb, 1.0 / (count + 1.0)), count + 1.0);
  outSeen = vec4(octahedralFromUnit(texelFetch(gbufferNormal, pixel, 0).xyz), viewDistanceFromDepth(camera, depth),
                 count + 1.0);
#ifdef GLOSSY
  outGlossy = vec4(texelFetch(glossy, placeOf(pixel), 0).rgb, 1.0);
#endif
}
