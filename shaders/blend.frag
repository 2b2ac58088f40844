#version 450
// Mixes pixels where blended surfaces are, of which each shows one of those, or what is behind them
// (shared/coverage.h): means over neighbours that show the one kind, and the other, by the share let through.
layout(binding = 2) uniform sampler2D radiance;
layout(binding = 3) uniform sampler2D blended; // GBuffer::blended
layout(location = 0) out vec4 outRadiance;

const int kReach = 2, kFarReach = 6; // the second where one kind is rare, and not within the first

/// The nearest count most, so that what is seen stays sharp. Of blended surfaces less so, for where several are, each
/// pixel shows one.
float meanWeight(ivec2 offset, bool solid) {
  float near = 1.0 / float(1 + offset.x * offset.x + offset.y * offset.y);
  return near * near * (solid ? near : 1.0);
}

/// Pixels that show what is behind blended surfaces, and those that show one: sums, and weights in alpha.
struct Kinds {
  vec4 solid, before;
};

Kinds kindsWithin(ivec2 pixel, int reach) {
  Kinds kinds = Kinds(vec4(0.0), vec4(0.0));
  ivec2 last = textureSize(radiance, 0) - 1;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      ivec2 offset = ivec2(x, y), at = pixel + offset;
      if (any(notEqual(at, clamp(at, ivec2(0), last)))) continue;
      vec2 there = texelFetch(blended, at, 0).rg;
      if (there.r == 1.0) continue;
      bool solid = there.g > 0.5;
      vec4 value = vec4(texelFetch(radiance, at, 0).rgb, 1.0) * meanWeight(offset, solid);
      if (solid) kinds.solid += value;
      else kinds.before += value;
    }
  return kinds;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outRadiance = texelFetch(radiance, pixel, 0);
  float through = texelFetch(blended, pixel, 0).r;
  if (through == 1.0) return;
  Kinds kinds = kindsWithin(pixel, kReach);
  if (kinds.solid.a == 0.0 || kinds.before.a == 0.0) kinds = kindsWithin(pixel, kFarReach);
  float solid = kinds.solid.a > 0.0 ? through : 0.0, before = kinds.before.a > 0.0 ? 1.0 - through : 0.0;
  outRadiance.rgb = (kinds.solid.rgb * (solid / max(kinds.solid.a, 1e-20)) +
                     kinds.before.rgb * (before / max(kinds.before.a, 1e-20))) / (solid + before);
}
