#version 450
// What history.frag found where light changes: its coarse part follows the filtered difference to this frame by
// `follow`, its fine part is averaged on. Variants: GLOSSY; LIGHTS (how much the lights themselves changed is known, and
// followed by that); SUBSETS (this frame's light is de-interleaved).
#include "lib/gbuffer.glsl"
#include "lib/subsets.glsl"
#include "lib/variance.glsl"
#include "shared/octahedral.h"

layout(binding = 2) uniform sampler2D kept;     // a: frames that its mean counts as
layout(binding = 3) uniform sampler2D change;   // this frame - kept; a: frames in the variance
layout(binding = 4) uniform sampler2D filtered; // of change
layout(binding = 6) uniform sampler2D shares;   // history_tiles.frag: share, its noise, mean square
layout(binding = 10) uniform sampler2D irradiance; // of this frame
uniform float follow; // share of a coarse change
uniform bool apart;   // pixels' noise is each its own: what exceeds it is followed wholly
#ifdef LIGHTS
layout(binding = 9) uniform sampler2D lights; // LightChangeMap
uniform float tileSide;                       // pixels
#endif
layout(location = 0) out vec4 outIrradiance;
layout(location = 1) out vec4 outSeen;
#ifdef GLOSSY
layout(binding = 5) uniform sampler2D glossy; // the mean with this frame's
layout(location = 2) out vec4 outGlossy;
#endif
layout(binding = 8) uniform sampler2D foundVariance; // with this frame's
uniform float effectiveSamples; // (Σw)²/Σw² of the filter's weights; 1: unfiltered, which is not told from noise
layout(location = 3) out vec2 outVariance;

const float kSure = 8.0, kLeast = 0.1; // a changed share of 1/16 is followed by half, none by a tenth
const float kCalm = 4.0; // variances: a coarse change within these is as likely noise
const float kNoise = 0.15, kCertain = 0.4; // changes of a tile: from here on it forgets, here wholly

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = outSeen = vec4(0.0);
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
  outVariance = vec2(0.0);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec4 before = texelFetch(kept, pixel, 0), difference = texelFetch(change, pixel, 0);
  vec3 tile = texture(shares, gl_FragCoord.xy / (16.0 * vec2(textureSize(shares, 0)))).rgb;
  float share = apart ? max(tile.r - tile.g, 0.0) : tile.r;
  float stays = 1.0 - smoothstep(kNoise, kCertain, share), count = before.a * stays, frames = count + 1.0;
  vec3 coarse = texelFetch(filtered, pixel, 0).rgb;
  float gain = follow;
#ifdef LIGHTS
  vec2 known = texture(lights, gl_FragCoord.xy / (tileSide * vec2(textureSize(lights, 0)))).rg;
  gain = clamp(kSure * known.r, kLeast, follow);
  // What was kept is made as bright as the lights say, as far as this frame agrees: lights behind walls say it too. What
  // they do not know is followed.
  vec3 gained = before.rgb * clamp(known.g > 0.0 ? known.g / (1.0 - known.g) : known.g, -0.5, 1.0);
  float wanted = dot(kLuminance, gained);
  gained *= wanted != 0.0 ? clamp(dot(kLuminance, coarse) / wanted, 0.0, 1.0) : 0.0;
  before.rgb += gained;
  difference.rgb -= gained;
  coarse -= gained;
#endif
  outVariance = texelFetch(foundVariance, pixel, 0).rg;
  float brightness = dot(kLuminance, coarse), noise = max(tile.b, outVariance.r) / effectiveSamples;
  if (apart && brightness != 0.0 && effectiveSamples > 1.0)
    gain = max(gain, 1.0 - kCalm * noise / (brightness * brightness));
  vec3 brought = max(before.rgb + gain * coarse, 0.0);
  outIrradiance = vec4(mix(brought, before.rgb + difference.rgb, 1.0 / frames), frames);
  // A mean that begins again is this frame: the sum may have none of its digits after light 10⁷ times as bright.
  vec3 now = texelFetch(irradiance, placeOf(pixel), 0).rgb;
  if (count == 0.0 && !any(isnan(now)) && !any(isinf(now))) outIrradiance.rgb = now;
  // Where the mean begins again the variance found so far is a guess; of light that became darker, a smaller one.
  float left = brightness < 0.0 ? 1.0 - tile.r : 1.0;
  outVariance *= mix(left * left, 1.0, stays);
  outIrradiance.a = mix(1.0, difference.a, stays); // begun again, so its neighbours tell the variance
  outSeen = vec4(octahedralFromUnit(texelFetch(gbufferNormal, pixel, 0).xyz), viewDistanceFromDepth(camera, depth),
                 frames);
#ifdef GLOSSY
  outGlossy = texelFetch(glossy, pixel, 0);
#endif
}
