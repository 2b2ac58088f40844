#version 450
// Clusters of 2 × 2 of the level below: flux and area add up, position and normal are means weighted by flux (a dark
// cluster has none). The bound of the area takes all four as large as the largest, as the papers take the largest distance from
// the light: where a cluster spans a step, its mean would be refined too late for its far part.
layout(binding = 0) uniform sampler2D positions; // see ReflectiveMaps
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D fluxes;
layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outFlux;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * 2;
  outPosition = outNormal = outFlux = vec4(0.0);
  float weights = 0.0, largest = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 child = first + ivec2(i & 1, i >> 1);
    outFlux += texelFetch(fluxes, child, 0);
    largest = max(largest, texelFetch(positions, child, 0).a);
  }
  for (int i = 0; i < 4; ++i) {
    ivec2 child = first + ivec2(i & 1, i >> 1);
    float weight = dot(texelFetch(fluxes, child, 0).rgb, vec3(1.0));
    outPosition.xyz += weight * texelFetch(positions, child, 0).xyz;
    outNormal.xyz += weight * texelFetch(normals, child, 0).xyz;
    weights += weight;
  }
  if (weights > 0.0) {
    outPosition.xyz /= weights;
    outNormal.xyz /= weights;
  }
  outPosition.a = 4.0 * largest;
}
