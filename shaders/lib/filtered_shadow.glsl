// What a shadow map lets through, by comparisons that are blended. Variants as direct.frag.
#ifdef CUBE_MAPS
layout(binding = 2) uniform samplerCubeArrayShadow maps;
#else
layout(binding = 2) uniform sampler2DArrayShadow maps;
#endif

/// The receiver, moved along its normal by as much as `texels` of the map can differ in depth on its plane: the depth
/// error is texels·tanθ along the ray, so the shift is texels·sinθ; half a texel more is for the rasteriser's rounding.
vec3 liftedReceiver(vec3 position, vec3 normal, float cosine, float texel, float texels) {
  return position + normal * (texel * (texels * sqrt(max(0.0, 1.0 - cosine * cosine)) + 0.5));
}

#ifndef CUBE_MAPS
/// 3×3 texels through four bilinear comparisons.
float filteredShadow(vec3 map, float layer) {
  vec2 step = 0.5 / vec2(textureSize(maps, 0).xy);
  return 0.25 * (texture(maps, vec4(map.xy + vec2(-step.x, -step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(step.x, -step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(-step.x, step.y), layer, map.z)) +
                 texture(maps, vec4(map.xy + vec2(step.x, step.y), layer, map.z)));
}
#endif

float shadowOf(LightRecord light, vec3 position, vec3 normal, float cosine) {
  float layer = light.intensityLayer.w;
#ifdef SUN_MAPS
  vec3 lifted = liftedReceiver(position, normal, cosine, light.directionTexel.w, 2.0);
  return filteredShadow((light.mapFromWorld * vec4(lifted, 1.0)).xyz, layer);
#else
  vec3 toLight = light.positionRange.xyz - position;
#ifdef EMITTER_MAPS
  // What the receiver's plane can rise within a texel and a half, and a tenth for round-off.
  float distance = length(toLight);
  vec3 d = mat3(light.mapFromWorld) * (toLight / -distance);
  float texel = 1.5 * light.directionTexel.w * (1.0 + d.z);
  float reach = distance * max(1.0 - texel * (tangentOf(cosine) + 0.1), 0.0) / light.coneNear.z;
  return texture(maps, vec4(paraboloidFromDirection(d), layer, leastParaboloidValue(reach)));
#elif defined(CUBE_MAPS)
  float texel = light.directionTexel.w * axisDistance(toLight);
  vec3 fromLight = liftedReceiver(position, normal, cosine, texel, 1.5) - light.positionRange.xyz;
  return texture(maps, vec4(fromLight, layer), light.coneNear.z / axisDistance(fromLight));
#else
  vec4 own = light.mapFromWorld * vec4(position, 1.0); // w: along the map's axis
  float texel = light.directionTexel.w * own.w;
  vec4 map = light.mapFromWorld * vec4(liftedReceiver(position, normal, cosine, texel, 2.0), 1.0);
  return filteredShadow(map.xyz / map.w, layer);
#endif
#endif
}
