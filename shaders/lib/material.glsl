// A material's textures at mesh coordinates. Units 2 to 5 and uniform binding 1 belong to it.
#include "shared/material_block.h"

layout(std140, binding = 1) uniform MaterialUniforms { MaterialBlock material; };
layout(binding = 2) uniform sampler2D baseTexture;
layout(binding = 3) uniform sampler2D emissiveTexture;
layout(binding = 4) uniform sampler2D roughnessMetalnessTexture;
layout(binding = 5) uniform sampler2D normalTexture;

vec2 transformUv(vec4 rowU, vec4 rowV, vec4 uv01) {
  vec3 uv = vec3(rowU.w > 0.5 ? uv01.zw : uv01.xy, 1.0);
  return vec2(dot(rowU.xyz, uv), dot(rowV.xyz, uv));
}

/// Albedo and alpha.
vec4 baseColorAt(vec4 uv01, vec4 vertexColor) {
  vec4 base = material.baseColor * vertexColor;
#ifdef BASE_TEXTURE
  vec2 uv = transformUv(material.baseUvU, material.baseUvV, uv01);
#ifdef FINEST_LEVEL
  base *= textureLod(baseTexture, uv, 0.0);
#else
  base *= texture(baseTexture, uv);
#endif
#endif
  return base;
}

#ifdef ALPHA_MASK
#if defined(ALPHA_BLEND) || defined(CHECKERED) || defined(SOLID)
#include "shared/coverage.h"
#endif
#ifdef ALPHA_BLEND
layout(location = 6) flat in uint instance;
#endif
/// Whether the surface is not there for this pixel.
bool isCutOut(float alpha) {
#ifdef ALPHA_BLEND
  return !isCovered(alpha, pixelKey(uint(gl_FragCoord.x), uint(gl_FragCoord.y)), instance, uint(gl_PrimitiveID));
#elif defined(CHECKERED)
  bool other = (int(gl_FragCoord.x) + int(gl_FragCoord.y)) % 2 == 0;
  return alpha <= kLeastBlended || (alpha < 1.0 - kLeastBlended && other);
#elif defined(SOLID)
  return alpha < 1.0 - kLeastBlended;
#else
  return alpha < material.emission.a;
#endif
}
#endif

vec3 emissionAt(vec4 uv01) {
#ifdef EMISSIVE_TEXTURE
  vec2 uv = transformUv(material.emissiveUvU, material.emissiveUvV, uv01);
  return material.emission.rgb * texture(emissiveTexture, uv).rgb;
#else
  return material.emission.rgb;
#endif
}

#ifdef NORMAL_TEXTURE
/// Texel of the normal map; a: see meanNormalLength.
vec4 normalTexelAt(vec4 uv01) {
  return texture(normalTexture, transformUv(material.normalUvU, material.normalUvV, uv01));
}
#endif

/// Roughness and metalness.
vec2 roughnessMetalnessAt(vec4 uv01) {
  vec2 roughnessMetalness = material.roughnessMetalness.xy;
#ifdef FINISH_TEXTURE
  roughnessMetalness *= texture(roughnessMetalnessTexture, transformUv(material.roughnessMetalnessUvU, material.roughnessMetalnessUvV, uv01)).gb;
#endif
  return roughnessMetalness;
}
