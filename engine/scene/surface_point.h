// Points that ride on a surface: a place on a triangle, where the scene has it now, and what is there.
#pragma once

#include "engine/scene/scene_view.h"

namespace lambent {

/// World space. Both normals are unit and on the front side as glTF defines it (counter-clockwise, turned with a
/// mirrored instance), unlike a hit's, which face the ray. Zero where the triangle has no area and so no side.
struct SurfacePoint {
  vec3 position{0};
  vec3 normal{0};          // shading
  vec3 geometricNormal{0}; // the triangle's
};

/// The point of a triangle (numbered within its primitive) at `barycentric`, the weights of its second and third
/// corner: all as a SurfaceHit has them. Uses the deformed vertices where there are any.
SurfacePoint surfacePoint(const SceneView& view, uint32_t instance, uint32_t primitive, uint32_t triangle,
                          vec2 barycentric);

/// How a surface reflects, apart from its colour: factors times texture.
struct RoughnessMetalness {
  float roughness = 1, metalness = 0; // roughness is perceptual
};
RoughnessMetalness roughnessMetalnessAt(const SceneView& view, uint32_t instance, uint32_t primitive, uint32_t triangle,
                                        vec2 barycentric);

} // namespace lambent
