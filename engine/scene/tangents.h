// Tangents for normal maps, where a file has none.
#pragma once

#include "engine/core/math.h"

#include <span>
#include <vector>

namespace lambent {

/// The tangent space of a triangle's corner.
struct CornerTangent {
  uint32_t group = 0;       // of the vertex's corners: those of one group have one tangent
  vec4 tangent{1, 0, 0, 1}; // unit, object space; w: bitangent = w · cross(normal, tangent)
};

/// Makes a tangent for each corner, triangle by triangle, as those who bake normal maps do: MikkTSpace (Mikkelsen 2008,
/// "Simulation of wrinkled surfaces revisited", 5.2, and its reference code's default of no angle that divides). Around
/// a vertex the triangles that share edges and whose texture is not mirrored against one another are one group; its
/// tangent is the mean of theirs, each in the vertex's tangent plane, by the angle that it has there. `uvs` have v
/// downwards, as glTF's. Arrays are per vertex; vertices with the same position, normal and coordinates count as one.
std::vector<CornerTangent> cornerTangents(std::span<const vec3> positions, std::span<const vec3> normals,
                                          std::span<const vec2> uvs, std::span<const uvec3> triangles);

} // namespace lambent
