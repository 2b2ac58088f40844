// glTF primitives to one triangle mesh: all modes made into triangle lists, vertices of primitives that share their
// accessors kept once, defects dropped and counted, missing normals made.

#include "engine/scene/gltf_import.h"

#include <array>
#include <cmath>

namespace lambent::gltf {

namespace {

enum Mode { Points, Lines, LineLoop, LineStrip, Triangles, TriangleStrip, TriangleFan };

/// The accessors a primitive's vertices come from; -1 where it has none.
using VertexKey = std::array<int, 9>;
constexpr std::array<const char*, 9> kAttributes = {"POSITION", "NORMAL",    "TEXCOORD_0", "TEXCOORD_1", "COLOR_0",
                                                    "JOINTS_0", "WEIGHTS_0", "JOINTS_1",   "WEIGHTS_1"};
enum Attribute { Position, Normal, Uv0, Uv1, Color, Joints0, Weights0, Joints1, Weights1 };

VertexKey vertexKey(const Primitive& primitive) {
  VertexKey key;
  for (size_t i = 0; i < key.size(); ++i) {
    const auto found = primitive.attributes.find(kAttributes[i]);
    key[i] = found == primitive.attributes.end() ? -1 : found->second;
  }
  return key;
}

/// Vertices of one primitive before they join the mesh; empty arrays where the file has none.
struct Vertices {
  std::vector<vec3> positions, normals;
  std::vector<vec2> uv0, uv1;
  std::vector<vec4> colors;
};

template <class V> void replaceNonFinite(std::vector<V>& values, const V& replacement) {
  for (V& v : values)
    for (int c = 0; c < V::length(); ++c)
      if (!std::isfinite(v[c])) v = replacement;
}

std::vector<vec4> readColors(const Document& doc, int accessor, const std::string& place) {
  const Accessor& a = doc.at(doc.accessors, accessor, "accessor", place);
  if (a.components == 4) return readAccessor<vec4>(doc, accessor, place);
  std::vector<vec4> colors;
  for (const vec3& c : readAccessor<vec3>(doc, accessor, place)) colors.emplace_back(c, 1);
  return colors;
}

/// Poses vertices by up to eight joints each. `matrices` are the skin's, in the space the mesh ends up in.
void applySkin(const Document& doc, Vertices& vertices, const VertexKey& key, const std::vector<mat4>& matrices,
               const std::string& place) {
  const size_t count = vertices.positions.size();
  std::vector<mat4> blended(count, mat4(0));
  std::vector<float> total(count, 0);
  for (const auto& [jointsAt, weightsAt] : {std::pair(Joints0, Weights0), std::pair(Joints1, Weights1)}) {
    if (key[jointsAt] < 0 || key[weightsAt] < 0) continue;
    const auto joints = readIndices(doc, key[jointsAt], 4, place + ", " + kAttributes[jointsAt]);
    const auto weights = readAccessor<vec4>(doc, key[weightsAt], place + ", " + kAttributes[weightsAt]);
    if (joints.size() != 4 * count || weights.size() != count)
      doc.fail(place, "has not as many joints and weights as positions");
    for (size_t i = 0; i < count; ++i)
      for (int c = 0; c < 4; ++c) {
        const float weight = weights[i][c];
        if (!(weight > 0)) continue;
        const uint32_t joint = joints[4 * i + size_t(c)];
        if (joint >= matrices.size())
          doc.fail(place, "vertex " + std::to_string(i) + " follows joint " + std::to_string(joint) +
                              ", but the skin has " + std::to_string(matrices.size()));
        blended[i] += weight * matrices[joint];
        total[i] += weight;
      }
  }
  for (size_t i = 0; i < count; ++i) {
    if (!(total[i] > 0)) continue;
    const mat4 m = blended[i] / total[i];
    vertices.positions[i] = vec3(m * vec4(vertices.positions[i], 1));
    if (!vertices.normals.empty()) vertices.normals[i] = glm::transpose(glm::inverse(mat3(m))) * vertices.normals[i];
  }
}

Vertices readVertices(const Document& doc, const VertexKey& key, const std::vector<mat4>& skinMatrices,
                      const std::string& place) {
  const auto at = [&](Attribute a) { return place + ", " + kAttributes[a]; };
  Vertices v;
  v.positions = readAccessor<vec3>(doc, key[Position], at(Position));
  if (key[Normal] >= 0) v.normals = readAccessor<vec3>(doc, key[Normal], at(Normal));
  if (key[Uv0] >= 0) v.uv0 = readAccessor<vec2>(doc, key[Uv0], at(Uv0));
  if (key[Uv1] >= 0) v.uv1 = readAccessor<vec2>(doc, key[Uv1], at(Uv1));
  if (key[Color] >= 0) v.colors = readColors(doc, key[Color], at(Color));
  const auto checkCount = [&](Attribute a, size_t count) {
    if (key[a] >= 0 && count != v.positions.size())
      doc.fail(at(a), "has " + std::to_string(count) + " elements, but there are " +
                          std::to_string(v.positions.size()) + " positions");
  };
  checkCount(Normal, v.normals.size());
  checkCount(Uv0, v.uv0.size());
  checkCount(Uv1, v.uv1.size());
  checkCount(Color, v.colors.size());
  replaceNonFinite(v.uv0, vec2(0));
  replaceNonFinite(v.uv1, vec2(0));
  replaceNonFinite(v.colors, vec4(1));
  if (!skinMatrices.empty()) applySkin(doc, v, key, skinMatrices, place);
  return v;
}

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

vec3 faceCross(const std::vector<vec3>& positions, const uvec3& t) {
  return glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
}

/// Takes out triangles that have no area or no position. The test is what later code computes to get a normal, in the
/// same precision, so that no later normal is NaN.
void dropDefects(Import& import, std::vector<uvec3>& triangles, const std::vector<vec3>& positions) {
  size_t notFinite = 0, noArea = 0;
  std::erase_if(triangles, [&](const uvec3& t) {
    const vec3 cross = faceCross(positions, t);
    const float squared = glm::dot(cross, cross);
    const bool bad =
        !isFinite(positions[t.x]) || !isFinite(positions[t.y]) || !isFinite(positions[t.z]) || !std::isfinite(squared);
    const bool flat = !bad && squared < std::numeric_limits<float>::min();
    notFinite += bad;
    noArea += flat;
    return bad || flat;
  });
  if (noArea) import.counted["triangle(s) without area left out"] += noArea;
  if (notFinite) import.counted["triangle(s) with a position that is not a finite number left out"] += notFinite;
}

/// One vertex per triangle corner, each with its triangle's normal (glTF: "flat normals" where none are given).
void makeFlat(Vertices& v, std::vector<uvec3>& triangles) {
  Vertices flat;
  const auto unweld = [&](auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(triangles.size() * 3);
    for (const uvec3& t : triangles)
      for (int c = 0; c < 3; ++c) to.push_back(from[t[c]]);
  };
  unweld(v.positions, flat.positions);
  unweld(v.uv0, flat.uv0);
  unweld(v.uv1, flat.uv1);
  unweld(v.colors, flat.colors);
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    flat.normals.insert(flat.normals.end(), 3, glm::normalize(faceCross(v.positions, triangles[i])));
    triangles[i] = uvec3(3 * i, 3 * i + 1, 3 * i + 2);
  }
  v = std::move(flat);
}

/// Makes all normals unit; those that have no direction become the mean of their triangles' normals.
void repairNormals(Vertices& v, const std::vector<uvec3>& triangles) {
  std::vector<uint32_t> broken;
  for (uint32_t i = 0; i < v.normals.size(); ++i) {
    const float length = glm::length(v.normals[i]);
    if (length > 1e-12f && std::isfinite(length)) {
      v.normals[i] /= length;
    } else {
      v.normals[i] = vec3(0);
      broken.push_back(i);
    }
  }
  if (broken.empty()) return;
  std::vector<vec3> sums(v.normals.size(), vec3(0));
  for (const uvec3& t : triangles)
    for (int c = 0; c < 3; ++c) sums[t[c]] += faceCross(v.positions, t);
  for (const uint32_t i : broken) {
    const float length = glm::length(sums[i]);
    v.normals[i] = length > 0 && std::isfinite(length) ? sums[i] / length : vec3(0, 1, 0);
  }
}

/// Appends an optional attribute, filling up what earlier or this primitive lacks; stays empty while nobody has it.
template <class V>
void appendOptional(std::vector<V>& to, const std::vector<V>& from, size_t before, size_t added, const V& absent) {
  if (to.empty() && from.empty()) return;
  to.resize(before, absent);
  to.insert(to.end(), from.begin(), from.end());
  to.resize(before + added, absent);
}

uint32_t appendVertices(lambent::Mesh& mesh, Vertices& v) {
  const size_t before = mesh.positions.size(), added = v.positions.size();
  for (vec3& p : v.positions)
    if (!isFinite(p)) p = vec3(0); // no triangle left uses it
  mesh.positions.insert(mesh.positions.end(), v.positions.begin(), v.positions.end());
  mesh.normals.insert(mesh.normals.end(), v.normals.begin(), v.normals.end());
  appendOptional(mesh.uv0, v.uv0, before, added, vec2(0));
  appendOptional(mesh.uv1, v.uv1, before, added, vec2(0));
  appendOptional(mesh.colors, v.colors, before, added, vec4(1));
  return uint32_t(before);
}

void appendTriangles(lambent::Mesh& mesh, const std::vector<uvec3>& triangles, uint32_t firstVertex,
                     uint32_t material) {
  lambent::Primitive primitive;
  primitive.firstTriangle = uint32_t(mesh.triangles.size());
  primitive.triangleCount = uint32_t(triangles.size());
  primitive.material = material;
  for (const uvec3& t : triangles) {
    mesh.triangles.push_back(t + firstVertex);
    for (int c = 0; c < 3; ++c) primitive.boundsObject.add(mesh.positions[t[c] + firstVertex]);
  }
  mesh.boundsObject.add(primitive.boundsObject);
  mesh.primitives.push_back(primitive);
}

} // namespace

uint32_t importMesh(Import& import, int meshIndex, int skinnedNode) {
  const std::pair key(meshIndex, skinnedNode);
  if (const auto known = import.meshes.find(key); known != import.meshes.end()) return known->second;
  Document& doc = import.doc;
  const Mesh& in = doc.meshes[size_t(meshIndex)];
  lambent::Mesh mesh;
  mesh.name = in.name.empty() ? "mesh " + std::to_string(meshIndex) : in.name;
  const std::vector<mat4> skinMatrices = skinnedNode >= 0 ? restSkinMatrices(import, skinnedNode) : std::vector<mat4>();

  struct Shared { // vertices that an earlier primitive has put into the mesh, as they were read
    uint32_t first;
    std::vector<vec3> positions;
  };
  std::map<VertexKey, Shared> shared;
  for (size_t i = 0; i < in.primitives.size(); ++i) {
    const Primitive& primitive = in.primitives[i];
    const std::string place = label("mesh", size_t(meshIndex), in.name) + ", primitive " + std::to_string(i);
    if (primitive.mode < Points || primitive.mode > TriangleFan)
      doc.fail(place, "mode " + std::to_string(primitive.mode) + " is not one of glTF's (0 to 6)");
    if (primitive.mode < Triangles) {
      import.counted["primitive(s) of points or lines left out"]++;
      continue;
    }
    const VertexKey vertexSource = vertexKey(primitive);
    if (vertexSource[Position] < 0) {
      import.counted["primitive(s) without positions left out"]++;
      continue;
    }
    if (primitive.morphTargets) import.counted["primitive(s) with morph targets shown without them"]++;
    if (primitive.material >= 0) doc.checkIndex(primitive.material, doc.materials.size(), "material", place);

    const auto known = shared.find(vertexSource);
    Vertices vertices;
    if (known == shared.end()) vertices = readVertices(doc, vertexSource, skinMatrices, place);
    const auto& positions = known == shared.end() ? vertices.positions : known->second.positions;
    std::vector<uvec3> triangles = readTriangles(doc, primitive, positions.size(), place);
    dropDefects(import, triangles, positions);
    if (triangles.empty()) continue;

    uint32_t first;
    if (known != shared.end()) {
      first = known->second.first;
    } else if (vertices.normals.empty()) {
      makeFlat(vertices, triangles);
      first = appendVertices(mesh, vertices);
    } else {
      std::vector<vec3> asRead = vertices.positions;
      repairNormals(vertices, triangles);
      first = appendVertices(mesh, vertices);
      shared.emplace(vertexSource, Shared{first, std::move(asRead)});
    }
    appendTriangles(mesh, triangles, first, importMaterial(import, primitive.material));
  }

  uint32_t slot = kNone;
  if (!mesh.triangles.empty()) {
    slot = uint32_t(import.scene.assets.meshes.size());
    import.scene.assets.meshes.push_back(std::move(mesh));
  }
  import.meshes.emplace(key, slot);
  return slot;
}

} // namespace lambent::gltf
