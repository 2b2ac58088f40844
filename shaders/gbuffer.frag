#version 450
// Surface attributes seen by the camera. Variants: GLOSSY (roughness and metalness too), MAPPED_NORMALS (the normal by
// the normal map too; NORMAL_TEXTURE: the material has one), KEEPS_MODE (for llvmpipe, Mesa 22.3: where the depth test
// rejects a whole block of pixels of a draw to half floats without any discard, the thread no longer flushes denormals to
// zero, and what it draws from then on may differ from what other threads draw).
#include "lib/material.glsl"
#include "shared/camera_block.h"

layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(location = 0) in vec3 normalWorld;
layout(location = 1) in vec3 positionEye;
layout(location = 2) in vec4 uv;
layout(location = 3) in vec4 color;
layout(location = 4) flat in float handedness;
layout(location = 0) out vec4 outNormal;
layout(location = 1) out vec4 outAlbedo;
layout(location = 2) out vec4 outEmission;
#ifdef GLOSSY
layout(location = 3) out vec4 outFinish;
#endif

#ifdef MAPPED_NORMALS
#include "shared/normal_map.h"
#ifdef NORMAL_TEXTURE
layout(location = 5) in vec4 tangentWorld;
#endif
layout(location = 4) out vec4 outMappedNormal;
#endif

void main() {
  // What differs from pixel to pixel comes before any discard: afterwards a driver may have no neighbours to ask.
  vec4 base = baseColorAt(uv, color);
  vec3 emission = emissionAt(uv), across = dFdx(positionEye), up = dFdy(positionEye);
  vec2 roughnessMetalness = roughnessMetalnessAt(uv);
#ifdef NORMAL_TEXTURE
  vec4 normalTexel = normalTexelAt(uv);
#endif
#ifdef KEEPS_MODE
  if (camera.size.x < 0.0) discard; // never, which the compiler cannot know
#endif
#ifdef ALPHA_MASK
  if (isCutOut(base.a)) discard;
#endif
  vec3 towardsViewer = camera.lens.w > 0.0 ? camera.worldFromView[2].xyz : -normalize(positionEye);
  vec3 geometric = cross(across, up);
  float size = length(geometric);
  geometric = size > 0.0 ? geometric / size : towardsViewer;
  if (dot(geometric, towardsViewer) < 0.0) geometric = -geometric;

  // The shading normal on the geometric normal's side; where it still faces away (silhouettes of coarse meshes) the
  // geometric one is the only answer that agrees with what is seen.
  float long_ = length(normalWorld); // 0 where corners have none, or opposite ones
  vec3 normal = long_ > 0.0 ? normalWorld / long_ : geometric;
  float side = dot(normal, geometric) < 0.0 ? -1.0 : 1.0;
  normal *= side;
  if (!(dot(normal, towardsViewer) > 0.0)) normal = geometric;

  bool front = gl_FrontFacing == (handedness > 0.0);
  bool emits = front || material.baseUvV.w > 0.5;
  outNormal = vec4(normal, 1.0);
#ifdef NORMAL_TEXTURE
  vec3 mapped =
      mappedNormal(normalWorld, tangentWorld.xyz, sign(tangentWorld.w), normalTexel.xyz, material.roughnessMetalness.z);
  mapped = facingViewer(side * mapped, towardsViewer);
  bool any = dot(tangentWorld.xyz, tangentWorld.xyz) > 0.0;
  mapped = mirroringOutwards(mapped, geometric, towardsViewer, roughnessMetalness.y);
  float meanLength = any ? meanNormalLength(normalTexel.a, material.roughnessMetalness.z) : 1.0;
  outMappedNormal = vec4(any ? mapped : normal, meanLength);
#elif defined(MAPPED_NORMALS)
  outMappedNormal = outNormal;
#endif
  outAlbedo = vec4(clamp(base.rgb, 0.0, 1.0), 1.0);
#ifdef GLOSSY
  outFinish = vec4(roughnessMetalness, material.roughnessMetalness.w, material.roughnessMetalnessUvV.w);
#endif
  outEmission = vec4(emits ? emission : vec3(0.0), 1.0);
}
