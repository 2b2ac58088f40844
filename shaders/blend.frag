#version 450
// Mixes pixels where blended surfaces are, of which each shows one of those, or what is behind them
// (shared/coverage.h): means over neighbours that show the one kind, and the other, by the share let through.
layout(binding = 2) uniform sampler2D radiance;
layout(binding = 3) uniform sampler2D blended; // GBuffer::blended
layout(location = 0) out vec4 outRadiance;

const int kReach = 2, kFarReach = 6; // the second where one kind is rare, and not within the first

/// Pixels that show what is behind blended surfaces, and those that show one: sums, and weights in alpha.
struct Kinds {
  vec4 solid, before;
};

void add(inout Kinds kinds, ivec2 pixel, ivec2 offset) {
  ivec2 at = pixel + offset, last = textureSize(radiance, 0) - 1;
  if (any(notEqual(at, clamp(at, ivec2(0), last)))) return;
  vec2 there = texelFetch(blended, at, 0).rg;
  if (there.r == 1.0) return;
  vec4 value = vec4(texelFetch(radiance, at, 0).rgb, 1.0);
  // The nearest count most, so that what is seen stays sharp. Of blended surfaces less so, for where several are, each
  // pixel shows one.
  float near = 1.0 / float(1 + offset.x * offset.x + offset.y * offset.y);
  if (there.g > 0.5) kinds.solid += value * (near * near * near);
  else kinds.before += value * (near * near);
}

/// The ring of pixels `reach` away.
void addRing(inout Kinds kinds, ivec2 pixel, int reach) {
  for (int i = -reach; i < reach; ++i) {
    add(kinds, pixel, ivec2(i, -reach));
    add(kinds, pixel, ivec2(reach, i));
    add(kinds, pixel, ivec2(-i, reach));
    add(kinds, pixel, ivec2(-reach, -i));
  }
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outRadiance = texelFetch(radiance, pixel, 0);
  float through = texelFetch(blended, pixel, 0).r;
  if (through == 1.0) return;
  Kinds kinds = Kinds(vec4(0.0), vec4(0.0));
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x) add(kinds, pixel, ivec2(x, y));
  for (int reach = kReach + 1; reach <= kFarReach && (kinds.solid.a == 0.0 || kinds.before.a == 0.0); ++reach)
    addRing(kinds, pixel, reach);
  vec4 sum = vec4(0.0);
  if (kinds.solid.a > 0.0 && through > 0.0) sum += vec4(kinds.solid.rgb / kinds.solid.a, 1.0) * through;
  if (kinds.before.a > 0.0) sum += vec4(kinds.before.rgb / kinds.before.a, 1.0) * (1.0 - through);
  outRadiance.a = 1.0; // a surface is seen, also where the pixel shows the sky behind
  if (sum.a > 0.0) outRadiance.rgb = sum.rgb / sum.a;
}
