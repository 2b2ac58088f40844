// A material as the scene shaders read it: uniform block, std140.
#pragma once
#include "interop.h"
SHARED_BEGIN

struct MaterialBlock {
  vec4 baseColor; // rgb: albedo factor; a: alpha factor
  vec4 emission;  // rgb: radiance factor, W/(m² sr); a: alpha cutoff
  vec4 baseUvU;   // xyz: first row of uvTransform; w: UV set
  vec4 baseUvV;   // xyz: second row; w: 1 when double-sided
  vec4 emissiveUvU;
  vec4 emissiveUvV;
  vec4 roughnessMetalness;    // factors of roughness, metalness; z: the normal map's scale; w: Material::dielectricF0
  vec4 roughnessMetalnessUvU; // as baseUvU
  vec4 roughnessMetalnessUvV; // xyz: second row; w: Material::dielectricLobe
  vec4 normalUvU;             // as baseUvU
  vec4 normalUvV;             // xyz: second row
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::MaterialBlock) == 176);
#endif
