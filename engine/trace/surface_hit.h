// The surface at a place on a triangle: what all tracers of the scene's triangles say of a hit.
#pragma once

#include "engine/trace/ray_query.h"

namespace lambent {

/// An instance as rays find it.
struct TracedInstance {
  const Mesh& mesh;
  const std::vector<vec3>&positions, &normals; // object space: the mesh's, or as deformed
  mat3 normalFromObject{1};                    // transposed inverse of the instance's matrix
};

/// Where a ray met it.
struct TriangleMet {
  float t = 0;
  uint32_t instance = 0, primitive = 0, triangle = 0; // as SurfaceHit
  vec2 barycentric{0};
};

/// Returns the surface where a ray met a triangle. The hit is not valid if the instance's scale has squashed the
/// triangle to nothing. With `textures` the albedo has the texel's colour, else the texture's mean; `lookups` counts
/// the former.
SurfaceHit surfaceAt(const SceneAssets& assets, const TracedInstance& instance, const TriangleMet& met, const Ray& ray,
                     bool textures, uint64_t& lookups);

} // namespace lambent
