// A punctual light, a direction of the sky or a sample of an emissive surface as the direct pass reads it: element of a
// uniform block, std140.
#ifndef LAMBENT_SHARED_LIGHT_RECORD_H
#define LAMBENT_SHARED_LIGHT_RECORD_H
#include "interop.h"
SHARED_BEGIN

struct LightRecord {
  vec4 positionRange;  // xyz: world position; w: 1/range⁴, 0 when the range is infinite (samples: area, m²)
  vec4 directionTexel; // xyz: the way the light travels (samples: their normal); w: a map texel's size: metres
                       // (directional), else metres per metre of distance along the map's axis
  vec4 intensityLayer; // rgb: W/sr (samples: along their normal), or W/m² (directional); w: layer of the map array
  vec4 coneNear;       // x, y: scale and offset of glTF's angular attenuation; z: near plane of the map (samples: far
                       // distance), metres
  mat4 mapFromWorld;   // spot and directional: map coordinates and reversed depth, all in [0,1] after division by w;
                       // samples: rotation into the light's frame
};

const int kLightsPerBlock = 128; // 16 KiB, what every OpenGL offers

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(lambent::LightRecord) == 128);
#endif
#endif
