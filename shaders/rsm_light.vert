#version 450
// VPLs in the order of PackedLights (gi/contract/virtual_lights.h), one per vertex. GRID: of a regular grid over all maps, each with the
// light of its texel times what the grid's cell has of its solid angle; else: those of `compact`, in their order.
#include "lib/rsm_light.glsl"
#include "shared/solid_angle.h"

uniform int count; // of lights
#ifdef GRID
layout(binding = 0) uniform sampler2D positions;
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D fluxes;
uniform int resolution; // texels per side of a map
uniform int columns;    // of maps
uniform int gridColumns; // LightGrid
uniform int gridRows;
uniform int mapsWithOneMore;
uniform int exact;
layout(std140, binding = 3) uniform Lenses { vec4 lens[1024]; }; // by map: tangent of half the field of view; 0: parallel
#else
layout(binding = 0) uniform samplerBuffer compact;
#endif

void main() {
  int within = gl_VertexID % (kLightClasses * kLightsPerClass);
  int slot = gl_VertexID - within + within % kLightsPerClass * kLightClasses + within / kLightsPerClass;
  setNoLight();
  if (slot >= count) return;
#ifdef GRID
  ivec2 grid = ivec2(gridColumns, gridRows + 1);
  int map = 0, cell = slot - grid.x * grid.y * mapsWithOneMore;
  if (cell < 0) {
    cell = slot;
  } else {
    grid.y = gridRows;
    map = mapsWithOneMore;
  }
  map += cell / (grid.x * grid.y);
  cell %= grid.x * grid.y;
  ivec2 at = ivec2(cell % grid.x, cell / grid.x);
  ivec2 local = ivec2((vec2(at) + 0.5) * float(resolution) / vec2(grid));
  ivec2 texel = resolution * ivec2(map % columns, map / columns) + local;
  vec4 flux = texelFetch(fluxes, texel, 0);
  vec2 cellTexels = float(resolution) / vec2(grid);
  float share = cellTexels.x * cellTexels.y;
  float tangent = lens[map].x;
  if (tangent > 0.0 && exact != 0) {
    vec2 step = 2.0 * tangent / vec2(grid), texelStep = vec2(2.0 * tangent / float(resolution));
    vec2 lo = vec2(at) * step - tangent, texelLo = vec2(local) * texelStep - tangent;
    share = rectSolidAngle(lo, lo + step) / rectSolidAngle(texelLo, texelLo + texelStep);
  }
  setLight(texelFetch(positions, texel, 0).xyz, texelFetch(normals, texel, 0).xyz, flux.rgb * share, flux.a * share);
#else
  positionArea = texelFetch(compact, slot * 4);
  powerNormalX = texelFetch(compact, slot * 4 + 1);
  tangentNormalY = texelFetch(compact, slot * 4 + 2);
  bitangentNormalZ = texelFetch(compact, slot * 4 + 3);
#endif
}
