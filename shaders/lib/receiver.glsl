// The surface at a pixel as a glossy receiver (variants GLOSSY), and what it sends to the camera. Units 6 and 7 belong
// to it.
#include "gbuffer.glsl"
#include "shared/ggx.h"

layout(binding = 6) uniform sampler2D gbufferAlbedo;
layout(binding = 7) uniform sampler2D gbufferFinish; // as makeReceiver takes it

/// `position` and `normal` are the G-buffer's of that pixel, the latter as normalForLight has it.
Receiver receiverAt(ivec2 pixel, vec3 position, vec3 normal) {
  vec3 towardsViewer =
      camera.lens.w > 0.0 ? camera.worldFromView[2].xyz : normalize(camera.worldFromView[3].xyz - position);
  return makeReceiver(normal, towardsViewer, texelFetch(gbufferAlbedo, pixel, 0).rgb,
                      texelFetch(gbufferFinish, pixel, 0));
}

/// Glossy light as the passes store it, as if what comes from around the mirrored direction were even: its mean radiance,
/// times what the lobe reflects of it.
vec3 evenGlossy(ivec2 pixel, Receiver receiver, vec3 radiance) {
  float roughness = max(texelFetch(gbufferFinish, pixel, 0).r, kLeastRoughness);
  vec3 reflected = receiver.specular * lobeShare(roughness, receiver.cosViewer) +
                   receiver.grazing * schlickShare(roughness, receiver.cosViewer);
  return radiance * reflected / glossyTint(receiver);
}

/// Radiance towards the camera of irradiance and of glossy light as the passes store it, divided by glossyTint.
/// `depth` must not be 0.
vec3 reflectedAt(ivec2 pixel, float depth, vec3 irradiance, vec3 glossy) {
  vec3 normal = normalForLight(pixel, texelFetch(gbufferNormal, pixel, 0).xyz);
  Receiver receiver = receiverAt(pixel, positionFromDepth(pixel, depth), normal);
  return receiver.diffuse * 0.318309886 * irradiance + glossyTint(receiver) * glossy;
}
