#version 450
// Irradiance of pixels from the layered depth cube (paper 5, section 5): in the image that looks along the normal, and
// in both where two are nearly as good, the entries on the pixel's own surface around it. The one nearest to it counts,
// and of the others those that this one sees: light is mixed linearly between texels, and not through walls.
#include "lib/gbuffer.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#endif
#include "lib/light_outputs.glsl"
#include "shared/layered_cube.h"
#include "shared/octahedral.h"

// Texture buffers: software Mesa reads them faster than storage buffers.
layout(binding = 10) uniform usamplerBuffer firsts;  // two texels a column: of entries that face back along its axis, and of others
layout(binding = 11) uniform usamplerBuffer entries; // CubeTexel
layout(binding = 12) uniform usamplerBuffer nodes;   // CubeNode, two texels each
uniform int resolution;  // texels along an edge of each cube
uniform float brightest; // irradiance of the brightest entry, W/m²

const float kNextImage = 0.8; // of the largest part of the normal: from here on its axis is asked too

/// What counts as the pixel's surface.
struct Match {
  float leastCos; // between the pixel's normal, which may be interpolated or mapped, and the entry's
  float height;   // texels off the entry's plane; curved surfaces leave their planes between texels
};
const Match kOwn = Match(0.5, 1.0);
const Match kSlanted = Match(0.25, 0.2); // where nothing matches: slanted sides of joints and mouldings, which no ray met

vec3 irradianceOf(CubeTexel t) {
  vec3 mantissa = vec3(t.irradiance & 511u, t.irradiance >> 9 & 511u, t.irradiance >> 18 & 511u);
  return mantissa * exp2(float(t.irradiance >> 27) - 24.0) * (brightest * kCubeRange);
}

/// Bit of a step to a neighbouring column in CubeEntry::neighbours; none for the column itself.
uint bitOf(ivec2 s) {
  if (s.y == 0) return s.x > 0 ? 1u : s.x < 0 ? 2u : 0u;
  if (s.x == 0) return s.y > 0 ? 4u : 8u;
  return s.y > 0 ? (s.x > 0 ? 16u : 32u) : (s.x > 0 ? 64u : 128u);
}

/// The cube that a place lies in.
struct Cube {
  vec3 corner; // world
  float texel; // metres
  int firstColumn;
};

Cube cubeAt(vec3 position) {
  for (int node = 0;;) {
    uvec4 place = texelFetch(nodes, 2 * node), links = texelFetch(nodes, 2 * node + 1);
    vec3 corner = uintBitsToFloat(place.xyz);
    float texel = uintBitsToFloat(place.w);
    if (links.x == 0u) return Cube(corner, texel, int(links.y));
    ivec3 far = ivec3(greaterThan(position, corner + 0.5 * float(resolution) * texel));
    node = int(links.x) + far.x + 2 * far.y + 4 * far.z;
  }
}

struct Found {
  float off;    // texels from the pixel, across the column; beyond any: none
  float weight;
  vec3 irradiance;
  uint neighbours;
  vec2 way; // from the pixel
};

/// Of a column's entries on the surface at x (from the corner) the one nearest to it. `at`: x in texels of the image.
Found nearestIn(Cube cube, ivec2 column, int axis, vec2 at, vec3 x, vec3 normal, Match match) {
  Found found = Found(1e9, 0.0, vec3(0.0), 0u, vec2(0.0));
  if (any(lessThan(column, ivec2(0))) || any(greaterThanEqual(column, ivec2(resolution)))) return found;
  int blocks = resolution / kCubeBlock;
  ivec2 block = column / kCubeBlock, within = column % kCubeBlock;
  int index = cube.firstColumn + ((axis * blocks + block.y) * blocks + block.x) * kCubeBlock * kCubeBlock + within.y * kCubeBlock + within.x;
  index = 2 * index + int(normal[axis] > 0.0);
  int last = int(texelFetch(firsts, index + 1).r);
  for (int i = int(texelFetch(firsts, index).r); i < last; ++i) {
    uvec4 packed_ = texelFetch(entries, i);
    CubeTexel t = CubeTexel(packed_.x, uintBitsToFloat(packed_.y), packed_.z, packed_.w);
    vec3 n = unitFromOctahedral(unpackSnorm2x16(t.normal));
    float height = abs(dot(x, n) - t.distance) / cube.texel;
    if (height > match.height || dot(n, normal) < match.leastCos) continue;
    vec2 way = vec2(column) + (vec2(t.place >> 8 & 255u, t.place >> 16 & 255u) + 0.5) / 256.0 - at;
    float off = max(abs(way.x), abs(way.y)) + height;
    if (off >= found.off) continue;
    vec2 near = max(1.0 - abs(way), vec2(0.0));
    found = Found(off, near.x * near.y * (1.0 - 0.9 * height), irradianceOf(t), t.place & 255u, way);
  }
  return found;
}

/// Adds what an image holds around x; `share` of the image in all.
void lookUp(Cube cube, int axis, float share, vec3 x, vec3 normal, Match match, inout vec3 sum, inout float total,
            inout vec4 fallback) {
  vec2 at = vec2(x[(axis + 1) % 3], x[(axis + 2) % 3]) / cube.texel;
  ivec2 base = ivec2(floor(at - 0.5));
  Found found[4];
  int nearest = 0;
  for (int i = 0; i < 4; ++i) {
    found[i] = nearestIn(cube, base + ivec2(i & 1, i >> 1), axis, at, x, normal, match);
    if (found[i].off < found[nearest].off) nearest = i;
  }
  if (found[nearest].off > 1e8) return;
  Found anchor = found[nearest];
  for (int i = 0; i < 4; ++i) {
    if (found[i].off > 1e8) continue;
    ivec2 step_ = ivec2(i & 1, i >> 1) - ivec2(nearest & 1, nearest >> 1);
    if (i != nearest && (anchor.neighbours & bitOf(step_)) == 0u) continue;
    sum += share * found[i].weight * found[i].irradiance;
    total += share * found[i].weight;
  }
  if (anchor.off < fallback.w) fallback = vec4(anchor.irradiance, anchor.off);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  writeNoLight();
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  Cube cube = cubeAt(position);
  vec3 x = position - cube.corner, a = abs(normal);
  float most = max(a.x, max(a.y, a.z));
  vec3 sum = vec3(0.0);
  float total = 0.0;
  vec4 nearest = vec4(0.0, 0.0, 0.0, 1e9);
  for (int axis = 0; axis < 3; ++axis) {
    float share = smoothstep(kNextImage * most, most, a[axis]);
    if (share > 0.0) lookUp(cube, axis, share, x, normal, kOwn, sum, total, nearest);
  }
  // A mapped normal may lead to another image than the surface's own.
  for (int turn = 0; turn < 2 && nearest.w > 1e8; ++turn)
    for (int axis = 0; axis < 3; ++axis)
      lookUp(cube, axis, 1.0, x, normal, turn == 0 ? kOwn : kSlanted, sum, total, nearest);
  vec3 irradiance = total > 1e-3 ? sum / total : nearest.rgb;
  outIrradiance = vec4(irradiance, total > 1e-3 || nearest.w < 1e8 ? 1.0 : 0.0);
#ifdef GLOSSY
  Receiver receiver = receiverAt(pixel, position, normalForLight(pixel, normal));
  outGlossy = vec4(evenGlossy(pixel, receiver, irradiance * 0.318309886), 1.0);
#endif
}
