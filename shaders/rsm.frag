#version 450
// Reflective shadow map of one light: of what its view shows, position, flux that a texel reflects, and the area that it
// stands for across the light's way. Φ = ρ I ω for a point light or a spot, ρ E A for a sun (papers 2 and 3; glTF falloffs).
#include "lib/gbuffer.glsl"
#include "shared/solid_angle.h"

layout(binding = 2) uniform sampler2D albedo;
uniform ivec2 origin;        // of the map in the sheet
uniform vec3 intensity;      // W/sr, or W/m² (parallel)
uniform vec3 lightPosition;
uniform vec3 lightDirection; // the way the light travels
uniform float range4;        // 1/range⁴, 0 for infinite
uniform vec2 cone;           // scale and offset of glTF's angular attenuation
uniform float texelMean;     // ReflectiveMap::patchArea
uniform int exact;           // RsmSettings::exact
layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outFlux;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outPosition = outFlux = vec4(0.0);
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  if (depth == 0.0) return;
  // Lights and their maps stand above the surface, also of rounded corners.
  vec3 position = positionFromDepth(pixel - origin, depth) +
                  texelFetch(gbufferNormal, pixel, 0).xyz * placeSlack(camera, viewDistanceFromDepth(camera, depth));
  vec3 reflectance = texelFetch(albedo, pixel, 0).rgb;
  if (camera.lens.w > 0.0) { // parallel
    outPosition = vec4(position, texelMean);
    outFlux = vec4(reflectance * intensity * texelMean, texelMean);
    return;
  }
  vec3 fromLight = position - lightPosition;
  float distance2 = squaredLength(fromLight);
  float solidAngle = texelMean;
  if (exact != 0) {
    vec2 lo = (vec2(pixel - origin) * camera.size.zw * 2.0 - 1.0) * camera.lens.xy;
    solidAngle = rectSolidAngle(lo, lo + camera.size.zw * 2.0 * camera.lens.xy);
  }
  float window = clamp(1.0 - distance2 * distance2 * range4, 0.0, 1.0);
  float angular = clamp(dot(lightDirection, fromLight) * inversesqrt(distance2) * cone.x + cone.y, 0.0, 1.0);
  float area = solidAngle * distance2;
  outPosition = vec4(position, area);
  outFlux = vec4(reflectance * intensity * (window * angular * angular * solidAngle), area);
}
