// A glTF primitive's vertices, on their way into a mesh.
#pragma once

#include "engine/scene/gltf_import.h"

#include <array>
#include <compare>

namespace lambent::gltf {

/// The accessors that a primitive's vertices come from; -1 where it has none. Primitives with the same ones share
/// vertices.
struct VertexSource {
  struct Joints {
    int joints = -1, weights = -1;
    auto operator<=>(const Joints&) const = default;
  };
  struct Target {
    int positions = -1, normals = -1;
    auto operator<=>(const Target&) const = default;
  };
  int positions = -1, normals = -1, uv0 = -1, uv1 = -1, colors = -1;
  std::vector<Joints> joints; // JOINTS_0 with WEIGHTS_0, JOINTS_1 with WEIGHTS_1, …
  std::vector<Target> targets;

  auto operator<=>(const VertexSource&) const = default;
  /// Whether the triangles' area is not for good what it is in the file.
  bool deforms() const { return !joints.empty() || !targets.empty(); }
};
/// Joints are only looked at for a mesh that is shown with a skin.
VertexSource vertexSource(Import& import, const Primitive& primitive, bool skinned);

/// Vertices of one primitive before they join the mesh; empty arrays where the file has none.
struct Vertices {
  std::vector<vec3> positions, normals;
  std::vector<vec2> uv0, uv1;
  std::vector<vec4> colors;
  std::vector<JointSet> jointSets;
  std::vector<MorphTarget> targets;
};
Vertices readVertices(Import& import, const VertexSource& source, const std::string& place);

inline vec3 faceCross(const std::vector<vec3>& positions, const uvec3& t) {
  return glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
}

/// One vertex per triangle corner, each with its triangle's normal (glTF: "flat normals" where none are given).
void makeFlat(Vertices& vertices, std::vector<uvec3>& triangles);

/// Makes all normals unit; those that have no direction become the mean of their triangles' normals.
void repairNormals(Vertices& vertices, const std::vector<uvec3>& triangles);

/// Puts the vertices after those that the mesh has; returns the index of the first.
uint32_t appendVertices(lambent::Mesh& mesh, Vertices& vertices);

} // namespace lambent::gltf
