// glTF primitives to one triangle mesh: all modes made into triangle lists, vertices of primitives that share their
// accessors kept once, defects dropped and counted, missing normals made.

#include "engine/scene/gltf_vertices.h"

#include <cmath>

namespace lambent::gltf {

namespace {

enum Mode { Points, Lines, LineLoop, LineStrip, Triangles, TriangleStrip, TriangleFan };

/// Corners of all triangles as vertex indices of the primitive. A strip's odd triangles are turned, so that all face
/// the same way.
std::vector<uvec3> readTriangles(const Document& doc, const Primitive& primitive, size_t vertexCount,
                                 const std::string& place) {
  std::vector<uint32_t> corners;
  if (primitive.indices >= 0) {
    corners = readIndices(doc, primitive.indices, 1, place + ", indices");
    for (size_t i = 0; i < corners.size(); ++i)
      if (corners[i] >= vertexCount)
        doc.fail(place + ", indices, accessor " + std::to_string(primitive.indices),
                 "index " + std::to_string(corners[i]) + " at " + std::to_string(i) + " is beyond the last of " +
                     std::to_string(vertexCount) + " vertices");
  } else {
    corners.resize(vertexCount);
    for (size_t i = 0; i < vertexCount; ++i) corners[i] = uint32_t(i);
  }
  std::vector<uvec3> triangles;
  const size_t n = corners.size();
  doc.spend(n, sizeof(uvec3), place);
  if (primitive.mode == Triangles) {
    for (size_t i = 0; i + 2 < n; i += 3) triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
  } else if (primitive.mode == TriangleStrip) {
    for (size_t i = 0; i + 2 < n; ++i)
      triangles.emplace_back(corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]);
  } else {
    for (size_t i = 1; i + 1 < n; ++i) triangles.emplace_back(corners[i], corners[i + 1], corners[0]);
  }
  return triangles;
}

/// Takes out triangles that have no area or no position. The test is what later code computes to get a normal, in the
/// same precision, so that no later normal is NaN. Where the mesh deforms, only a pose shows whether there is an area.
void dropDefects(Import& import, std::vector<uvec3>& triangles, const std::vector<vec3>& positions, bool deforms) {
  size_t notFinite = 0, noArea = 0;
  std::erase_if(triangles, [&](const uvec3& t) {
    const vec3 cross = faceCross(positions, t);
    const float squared = glm::dot(cross, cross);
    const bool bad =
        !isFinite(positions[t.x]) || !isFinite(positions[t.y]) || !isFinite(positions[t.z]) || !std::isfinite(squared);
    const bool flat = !bad && !deforms && squared < std::numeric_limits<float>::min();
    notFinite += bad;
    noArea += flat;
    return bad || flat;
  });
  if (noArea) import.counted["triangle(s) without area left out"] += noArea;
  if (notFinite) import.counted["triangle(s) with a position that is not a finite number left out"] += notFinite;
}

void appendTriangles(lambent::Mesh& mesh, const std::vector<uvec3>& triangles, uint32_t firstVertex, uint32_t material,
                     bool flat) {
  lambent::Primitive primitive;
  primitive.firstTriangle = uint32_t(mesh.triangles.size());
  primitive.triangleCount = uint32_t(triangles.size());
  primitive.material = material;
  primitive.flat = flat;
  for (const uvec3& t : triangles) {
    mesh.triangles.push_back(t + firstVertex);
    for (int c = 0; c < 3; ++c) primitive.boundsObject.add(mesh.positions[t[c] + firstVertex]);
  }
  mesh.boundsObject.add(primitive.boundsObject);
  mesh.primitives.push_back(primitive);
}

/// The highest joint that a vertex follows, for the check against the skins that the mesh is shown with.
void noteJoints(HighestJoint& highest, const std::vector<JointSet>& sets, const std::string& place) {
  for (const JointSet& set : sets)
    for (size_t i = 0; i < set.joints.size(); ++i)
      for (int c = 0; c < 4; ++c)
        if (set.weights[i][c] > 0 && (highest.place.empty() || set.joints[i][c] > highest.joint))
          highest = {set.joints[i][c], place + ", vertex " + std::to_string(i)};
}

/// Bytes of a vertex with all that it may have.
size_t bytesPerVertex(const Vertices& v) {
  return 2 * sizeof(vec3) + 2 * sizeof(vec2) + sizeof(vec4) + v.jointSets.size() * 2 * sizeof(vec4) +
         v.targets.size() * 2 * sizeof(vec3);
}

} // namespace

uint32_t importMesh(Import& import, int meshIndex, bool skinned) {
  const std::pair key(meshIndex, skinned);
  if (const auto known = import.meshes.find(key); known != import.meshes.end()) return known->second;
  Document& doc = import.doc;
  const Mesh& in = doc.meshes[size_t(meshIndex)];
  lambent::Mesh mesh;
  mesh.name = in.name.empty() ? "mesh " + std::to_string(meshIndex) : in.name;
  HighestJoint highest;

  struct Shared { // vertices that an earlier primitive has put into the mesh, as they were read
    uint32_t first;
    std::vector<vec3> positions;
  };
  std::map<VertexSource, Shared> shared;
  for (size_t i = 0; i < in.primitives.size(); ++i) {
    const Primitive& primitive = in.primitives[i];
    const std::string place = label("mesh", size_t(meshIndex), in.name) + ", primitive " + std::to_string(i);
    if (primitive.mode < Points || primitive.mode > TriangleFan)
      doc.fail(place, "mode " + std::to_string(primitive.mode) + " is not one of glTF's (0 to 6)");
    if (primitive.mode < Triangles) {
      import.counted["primitive(s) of points or lines left out"]++;
      continue;
    }
    const VertexSource source = vertexSource(import, primitive, skinned);
    if (source.positions < 0) {
      import.counted["primitive(s) without positions left out"]++;
      continue;
    }
    if (source.targets.size() != in.primitives[0].targets.size())
      doc.fail(place, "has " + std::to_string(source.targets.size()) + " morph targets, but primitive 0 has " +
                          std::to_string(in.primitives[0].targets.size()));
    if (primitive.material >= 0) doc.checkIndex(primitive.material, doc.materials.size(), "material", place);

    const auto known = shared.find(source);
    Vertices vertices;
    if (known == shared.end()) {
      vertices = readVertices(import, source, place);
      noteJoints(highest, vertices.jointSets, place);
    }
    const auto& positions = known == shared.end() ? vertices.positions : known->second.positions;
    std::vector<uvec3> triangles = readTriangles(doc, primitive, positions.size(), place);
    dropDefects(import, triangles, positions, source.deforms());
    if (triangles.empty()) continue;

    const bool flat = source.normals < 0;
    uint32_t first;
    if (known != shared.end()) {
      first = known->second.first;
    } else if (flat) {
      doc.spend(3 * triangles.size(), bytesPerVertex(vertices), place);
      makeFlat(vertices, triangles);
      first = appendVertices(mesh, vertices);
    } else {
      doc.spend(vertices.positions.size(), bytesPerVertex(vertices), place); // what others have is filled up
      std::vector<vec3> asRead = vertices.positions;
      repairNormals(vertices, triangles);
      first = appendVertices(mesh, vertices);
      shared.emplace(source, Shared{first, std::move(asRead)});
    }
    appendTriangles(mesh, triangles, first, importMaterial(import, primitive.material), flat);
  }

  uint32_t slot = kNone;
  if (!mesh.triangles.empty()) {
    slot = uint32_t(import.scene.assets.meshes.size());
    import.scene.assets.meshes.push_back(std::move(mesh));
    import.highestJoints[slot] = highest;
  }
  import.meshes.emplace(key, slot);
  return slot;
}

} // namespace lambent::gltf
