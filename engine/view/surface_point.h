// Points that ride on a surface: a place on a triangle, where the scene has it now, and what is there.
#pragma once

#include "engine/view/scene_view.h"

namespace lambent {

/// A place on a triangle: its vertices and their weights.
struct TrianglePlace {
  uvec3 vertices;
  float w0, u, v;

  template <class T> T interpolate(const std::vector<T>& a) const {
    return a[vertices.x] * w0 + a[vertices.y] * u + a[vertices.z] * v;
  }
};

/// `triangle` is numbered within its primitive, `barycentric` are the weights of its second and third corner: all as a
/// SurfaceHit has them.
inline TrianglePlace trianglePlace(const Mesh& mesh, const Primitive& primitive, uint32_t triangle,
                                   const vec2& barycentric) {
  return {mesh.triangles[primitive.firstTriangle + triangle], 1 - barycentric.x - barycentric.y, barycentric.x,
          barycentric.y};
}

/// Coordinates for a texture; 0 where the mesh has none.
inline vec2 uvAt(const Mesh& mesh, const TrianglePlace& place, const TextureRef& ref) {
  const auto& uv = ref.uvSet == 0 ? mesh.uv0 : mesh.uv1;
  return uv.empty() ? vec2(0) : place.interpolate(uv);
}

/// Base colour, linear, and alpha: the material's × the texture's × the vertices'. `mean` (may be null) stands in for
/// the texture.
vec4 baseColourAt(const SceneAssets& assets, const Mesh& mesh, const Material& material, const TrianglePlace& place,
                  const vec4* mean = nullptr);
/// The last of these, without a mean: to the bit, and sooner.
float alphaAt(const SceneAssets& assets, const Mesh& mesh, const Material& material, const TrianglePlace& place);

/// Whether a surface of that alpha is there: at or above its mask's cutoff, or blended and covered
/// (shaders/shared/coverage.h) for a ray or pixel of `key`. `triangle` of the primitive.
bool isThere(const Material& material, float alpha, uint32_t key, uint32_t instance, uint32_t triangle);
/// Part of pixels and rays that meet a surface of that alpha.
float shareThere(const Material& material, float alpha);

/// World space. Both normals are unit and on the front side as glTF defines it (counter-clockwise, turned with a
/// mirrored instance), unlike a hit's, which face the ray. Zero where the triangle has no area and so no side.
struct SurfacePoint {
  vec3 position{0};
  vec3 normal{0};          // shading
  vec3 geometricNormal{0}; // the triangle's
};

/// The point of a triangle (as trianglePlace). Uses the deformed vertices where there are any.
SurfacePoint surfacePoint(const SceneView& view, uint32_t instance, uint32_t primitive, uint32_t triangle,
                          vec2 barycentric);

/// Unit normal, world space, that the surface's normal map gives it where the camera looks (`towardsViewer`, unit): on
/// that side. `normal` (SurfaceHit's) where material or mesh has no map. Arguments as surfacePoint.
vec3 mappedNormalAt(const SceneView& view, uint32_t instance, uint32_t primitive, uint32_t triangle, vec2 barycentric,
                    const vec3& normal, const vec3& towardsViewer);

/// How a surface reflects, apart from its colour, as shaders/shared/ggx.h takes it: factors times texture.
vec4 finishAt(const SceneView& view, uint32_t instance, uint32_t primitive, uint32_t triangle, vec2 barycentric);

} // namespace lambent
