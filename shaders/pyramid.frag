#version 450
// One level of the pyramid of patches, from the level below; FIRST: from pixels. A patch keeps the plane that fits it, as
// inverse depth over the image (affine for every plane, however steep), a bound of how far its pixels lie from that
// plane, and the range of their normals. It is split where these pass the thresholds, for balance where a patch next to it is
// split twice over (2:1), and, if larger than 2 × 2 pixels, where an edge runs along it. Serves the camera's image, and
// light maps that lie side by side (cells). Variant DEPTH_RANGE: a patch keeps its least and largest inverse depth instead
// of a plane, and is split where the range of its depths is too large (papers 2 and 3).
layout(binding = 0) uniform sampler2D depthMap;  // FIRST: reversed depth, 0 where nothing is seen
layout(binding = 1) uniform sampler2D normalMap; // FIRST
layout(binding = 0) uniform sampler2D planes;    // else: the level below
layout(binding = 1) uniform sampler2D normalsLo;
layout(binding = 2) uniform sampler2D normalsHi;
uniform ivec2 size;           // of the image, pixels
uniform ivec2 cell;           // of one map, children; patches never span two
uniform int childPixels;      // 2^(level − 1)
uniform int mayBeSplit;       // 0: not at this level, whatever it holds
uniform float depthThreshold;  // MultiresSettings::depth
uniform float normalThreshold; // MultiresSettings::normal
uniform float orthoScale;      // depth range over half the width, of maps by parallel rays: depths are not inverse there
uniform int orthoFrom;         // the first of these, row by row
uniform int columns;           // of maps
uniform int balance;           // MultiresSettings::balance
uniform int edges;             // MultiresSettings::edges
layout(location = 0) out vec4 outPlane;    // inverse depth at the centre (0: background, −1: outside), slope per pixel,
                                           // largest deviation; DEPTH_RANGE: least inverse depth, the same and the
                                           // largest, their difference
layout(location = 1) out vec4 outNormalLo; // a: 1 = to be split, kWhole = would be but may not
layout(location = 2) out vec4 outNormalHi; // a, of 2 × 2 pixels: 1 = whole, but an edge runs along its border

const float kSplit = 1e30;
const float kWhole = 0.25;

struct Child {
  float centre;
  vec2 slope; // DEPTH_RANGE: least and largest inverse depth
  float deviation;
  vec3 lo, hi;
};

float relativeTo(float deviation, float centre, ivec2 map) {
  return deviation * (map.x + map.y * columns >= orthoFrom ? orthoScale : 1.0 / centre);
}

bool turns(vec3 lo, vec3 hi) {
  vec3 range = hi - lo;
  return max(max(range.x, range.y), range.z) >= normalThreshold;
}

/// outPlane of the `surfaces` children of `inside` that show one.
vec4 mergedPlane(Child children[4], int surfaces, int inside) {
#ifdef DEPTH_RANGE
  vec2 range = vec2(kSplit, 0.0);
  for (int i = 0; i < 4; ++i)
    if (children[i].centre > 0.0)
      range = vec2(min(range.x, children[i].slope.x), max(range.y, children[i].slope.y));
  // Over the least inverse depth: the largest depth over the least, less one.
  return vec4(range.x, range, surfaces < inside ? kSplit : range.y - range.x);
#else
  vec2 slope = vec2(0.0);
  for (int i = 0; i < 4; ++i)
    if (children[i].centre > 0.0) slope += children[i].slope;
  slope /= float(surfaces);
  float centre = 0.0;
  for (int i = 0; i < 4; ++i) {
    if (!(children[i].centre > 0.0)) continue;
    vec2 offset = (vec2(i & 1, i >> 1) - 0.5) * float(childPixels);
    centre += children[i].centre - dot(slope, offset);
  }
  centre /= float(surfaces);
  // Pixel centres of a child lie within half of its pixels less one of its centre.
  float reach = 0.5 * float(childPixels - 1);
  float deviation = surfaces < inside || !(centre > 0.0) ? kSplit : 0.0;
  for (int i = 0; i < 4; ++i) {
    if (!(children[i].centre > 0.0)) continue;
    vec2 offset = (vec2(i & 1, i >> 1) - 0.5) * float(childPixels);
    vec2 turn = abs(children[i].slope - slope);
    deviation = max(deviation, children[i].deviation + abs(children[i].centre - centre - dot(slope, offset)) +
                                   (turn.x + turn.y) * reach);
  }
  return vec4(max(centre, 1e-30), slope, deviation);
#endif
}

#ifdef FIRST
/// How far a pixel next to the patch is from continuing it, as relativeTo.
float offThePatch(float neighbour, vec2 step, ivec2 map) {
#ifdef DEPTH_RANGE
  float least = min(neighbour, outPlane.y);
  return relativeTo(max(neighbour, outPlane.z) - least, least, map);
#else
  return relativeTo(abs(neighbour - outPlane.x - dot(outPlane.yz, step - 0.5)), outPlane.x, map);
#endif
}

/// Difference to the neighbour that continues the surface better: the smaller of both, none if they disagree.
float slopeOf(float before, float here, float after) {
  if (before <= 0.0) return after <= 0.0 ? 0.0 : after - here;
  if (after <= 0.0) return here - before;
  float a = here - before, b = after - here;
  return a * b <= 0.0 ? 0.0 : abs(a) < abs(b) ? a : b;
}

/// Depth of a pixel of the same map; −1 outside.
float depthAt(ivec2 pixel, ivec2 origin) {
  ivec2 within = pixel - origin;
  if (any(lessThan(within, ivec2(0))) || any(greaterThanEqual(within, cell)) || any(greaterThanEqual(pixel, size)))
    return -1.0;
  return texelFetch(depthMap, pixel, 0).r;
}

Child childAt(ivec2 pixel) {
  ivec2 origin = pixel / cell * cell;
  Child c = Child(depthAt(pixel, origin), vec2(0.0), 0.0, vec3(0.0), vec3(0.0));
  if (c.centre <= 0.0) return c;
  c.slope = vec2(slopeOf(depthAt(pixel - ivec2(1, 0), origin), c.centre, depthAt(pixel + ivec2(1, 0), origin)),
                 slopeOf(depthAt(pixel - ivec2(0, 1), origin), c.centre, depthAt(pixel + ivec2(0, 1), origin)));
#ifdef DEPTH_RANGE
  c.slope = vec2(c.centre);
#endif
  c.lo = c.hi = texelFetch(normalMap, pixel, 0).xyz;
  return c;
}
#else
Child childAt(ivec2 texel) {
  vec4 plane = texelFetch(planes, texel, 0);
  return Child(plane.x, plane.yz, plane.w, texelFetch(normalsLo, texel, 0).xyz, texelFetch(normalsHi, texel, 0).xyz);
}
#endif

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * 2;
  Child children[4];
  int surfaces = 0, inside = 0;
  vec3 lo = vec3(2.0), hi = vec3(-2.0);
  for (int i = 0; i < 4; ++i) {
    children[i] = childAt(first + ivec2(i & 1, i >> 1));
    inside += children[i].centre >= 0.0 ? 1 : 0;
    if (!(children[i].centre > 0.0)) continue;
    ++surfaces;
    lo = min(lo, children[i].lo);
    hi = max(hi, children[i].hi);
  }
  outPlane = vec4(inside > 0 ? 0.0 : -1.0, 0.0, 0.0, 0.0);
  outNormalLo = outNormalHi = vec4(0.0);
  if (surfaces > 0) {
    outPlane = mergedPlane(children, surfaces, inside);
    ivec2 map = first / cell;
    bool split = relativeTo(outPlane.w, outPlane.x, map) >= depthThreshold || turns(lo, hi);
    outNormalLo.xyz = lo;
    outNormalHi.xyz = hi;
    outNormalLo.a = split ? 1.0 : 0.0;
#ifdef FIRST
    // Patches may end where an edge runs, and have none inside. Light changes fast along it, and what is beyond says nothing
    // about this side, so patches next to it stay small.
    if (edges != 0 && !split) {
      ivec2 origin = map * cell;
      bool edge = false;
      for (int i = 0; i < 16; ++i) {
        ivec2 step = ivec2(i & 3, i >> 2) - 1;
        float neighbour = depthAt(first + step, origin);
        if (neighbour < 0.0) continue;
        vec3 normal = texelFetch(normalMap, first + step, 0).xyz;
        edge = edge || neighbour == 0.0 || offThePatch(neighbour, vec2(step), map) >= depthThreshold ||
               turns(min(lo, normal), max(hi, normal));
      }
      outNormalHi.a = edge ? 1.0 : 0.0;
    }
#endif
  }
#ifndef FIRST
  // A child that is split, or would be if it might, makes this one split, as does one with an edge along its border, and,
  // for balance, a split one next to it.
  ivec2 origin = first / cell * cell;
  int ring = balance;
  for (int y = -ring; y < 2 + ring; ++y) {
    for (int x = -ring; x < 2 + ring; ++x) {
      ivec2 texel = first + ivec2(x, y), within = texel - origin;
      if (any(lessThan(within, ivec2(0))) || any(greaterThanEqual(within, cell))) continue;
      bool own = all(greaterThanEqual(ivec2(x, y), ivec2(0))) && all(lessThan(ivec2(x, y), ivec2(2)));
      if (texelFetch(normalsLo, texel, 0).a > (own ? 0.0 : 0.5) || (own && texelFetch(normalsHi, texel, 0).a > 0.0))
        outNormalLo.a = 1.0;
    }
  }
#endif
  if (mayBeSplit == 0) outNormalLo.a *= kWhole;
}
