// glTF primitives to one triangle mesh: all modes made into triangle lists, vertices of primitives that share their
// accessors kept once, defects dropped and counted, missing normals made.

#include "engine/scene/gltf_compression.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/tangents.h"

#include <cmath>
#include <compare>
#include <map>
#include <utility>

namespace lambent::gltf {

namespace {

/// What rays and OpenGL keep of a triangle (300 meshes of 20 000 took 135 bytes each in all).
constexpr size_t kBytesPerTracedTriangle = 64;

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
  int positions = -1, normals = -1, uv0 = -1, uv1 = -1, colors = -1, tangents = -1;
  int tangentsOf = -1;        // the primitive whose triangles they are made from, which then shares with no other
  std::vector<Joints> joints; // JOINTS_0 with WEIGHTS_0, JOINTS_1 with WEIGHTS_1, …
  std::vector<Target> targets;

  auto operator<=>(const VertexSource&) const = default;
  /// Whether the triangles' area is not for good what it is in the file.
  bool deforms() const { return !joints.empty() || !targets.empty(); }
};

/// Vertices of one primitive before they join the mesh; empty arrays where the file has none.
struct Vertices {
  std::vector<vec3> positions, normals;
  std::vector<vec2> uv0, uv1;
  std::vector<vec4> colors, tangents;
  std::vector<JointSet> jointSets;
  std::vector<MorphTarget> targets;
};

vec3 faceCross(const std::vector<vec3>& positions, const uvec3& t) {
  return glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
}

int find(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

/// Returns how many it replaced.
template <class V> size_t replaceNonFinite(std::vector<V>& values, const V& replacement) {
  size_t replaced = 0;
  for (V& v : values) {
    bool finite = true;
    for (int c = 0; c < V::length(); ++c) finite = finite && std::isfinite(v[c]);
    if (!finite) v = replacement, ++replaced;
  }
  return replaced;
}

std::vector<vec4> readColors(const Document& doc, int accessor, const std::string& place) {
  if (componentsOf(doc.at(doc.model.accessors, accessor, "accessor", place)) == 4)
    return readAccessor<vec4>(doc, accessor, place);
  std::vector<vec4> colors;
  for (const vec3& c : readAccessor<vec3>(doc, accessor, place)) colors.emplace_back(c, 1);
  return colors;
}

void checkCount(const Document& doc, size_t count, size_t positions, const std::string& place) {
  if (count != positions)
    doc.fail(place,
             "has " + std::to_string(count) + " elements, but there are " + std::to_string(positions) + " positions");
}

/// An optional attribute: empty where the file has none.
template <class V>
std::vector<V> readOptional(const Document& doc, int accessor, size_t positions, const std::string& place) {
  if (accessor < 0) return {};
  std::vector<V> values = readAccessor<V>(doc, accessor, place);
  checkCount(doc, values.size(), positions, place);
  return values;
}

std::vector<JointSet> readJoints(Import& import, const VertexSource& source, size_t count, const std::string& place) {
  const Document& doc = import.doc;
  std::vector<JointSet> sets;
  std::vector<float> total(count, 0);
  for (size_t s = 0; s < source.joints.size(); ++s) {
    const std::string jointsPlace = place + ", JOINTS_" + std::to_string(s);
    const auto joints = readIndices(doc, source.joints[s].joints, 4, jointsPlace);
    checkCount(doc, joints.size() / 4, count, jointsPlace);
    JointSet& set = sets.emplace_back();
    set.weights = readOptional<vec4>(doc, source.joints[s].weights, count, place + ", WEIGHTS_" + std::to_string(s));
    for (size_t i = 0; i < count; ++i) {
      set.joints.emplace_back(joints[4 * i], joints[4 * i + 1], joints[4 * i + 2], joints[4 * i + 3]);
      for (int c = 0; c < 4; ++c) {
        float& weight = set.weights[i][c];
        if (!(weight >= 0) || !std::isfinite(weight)) {
          import.counted["joint weight(s) that are negative or not a number taken as zero"]++;
          weight = 0;
        }
        total[i] += weight;
      }
    }
  }
  for (JointSet& set : sets)
    for (size_t i = 0; i < count; ++i)
      if (total[i] > 0) set.weights[i] /= total[i];
  return sets;
}

/// Appends an optional attribute, filling up what earlier or this primitive lacks; stays empty while nobody has it.
template <class V>
void appendOptional(std::vector<V>& to, const std::vector<V>& from, size_t before, size_t added, const V& absent) {
  if (to.empty() && from.empty()) return;
  to.resize(before, absent);
  to.insert(to.end(), from.begin(), from.end());
  to.resize(before + added, absent);
}

/// Joints are only looked at for a mesh that is shown with a skin.
VertexSource vertexSource(Import& import, const tinygltf::Primitive& primitive, int index, bool skinned) {
  const auto& given = primitive.attributes;
  VertexSource source;
  source.positions = find(given, "POSITION");
  source.normals = find(given, "NORMAL");
  source.uv0 = find(given, "TEXCOORD_0");
  source.uv1 = find(given, "TEXCOORD_1");
  source.colors = find(given, "COLOR_0");
  if (primitive.material >= 0 && size_t(primitive.material) < import.doc.model.materials.size() &&
      import.doc.model.materials[size_t(primitive.material)].normalTexture.index >= 0) {
    if (source.normals >= 0) source.tangents = find(given, "TANGENT"); // "ignored where normals are not given"
    if (source.tangents < 0) source.tangentsOf = index;
  }
  for (int set = 0; skinned; ++set) {
    const std::string number = std::to_string(set);
    const VertexSource::Joints joints{find(given, "JOINTS_" + number), find(given, "WEIGHTS_" + number)};
    if (joints.joints < 0 && joints.weights < 0) break;
    if (joints.joints < 0 || joints.weights < 0) {
      import.counted["set(s) of joints without weights, or of weights without joints, left out"]++;
      break;
    }
    source.joints.push_back(joints);
  }
  for (const auto& target : primitive.targets) {
    // Without normals the faces have their own, also when morphed: offsets have nothing to be added to.
    source.targets.push_back({find(target, "POSITION"), source.normals >= 0 ? find(target, "NORMAL") : -1});
    for (const auto& [name, accessor] : target)
      if (name != "POSITION" && name != "NORMAL" && name != "TANGENT")
        import.counted["morph target(s) of " + name + " left out"]++;
  }
  return source;
}

Vertices readVertices(Import& import, const VertexSource& source, const std::string& place) {
  const Document& doc = import.doc;
  Vertices v;
  v.positions = readAccessor<vec3>(doc, source.positions, place + ", POSITION");
  const size_t count = v.positions.size();
  v.normals = readOptional<vec3>(doc, source.normals, count, place + ", NORMAL");
  v.uv0 = readOptional<vec2>(doc, source.uv0, count, place + ", TEXCOORD_0");
  v.uv1 = readOptional<vec2>(doc, source.uv1, count, place + ", TEXCOORD_1");
  if (source.colors >= 0) {
    v.colors = readColors(doc, source.colors, place + ", COLOR_0");
    checkCount(doc, v.colors.size(), count, place + ", COLOR_0");
  }
  v.tangents = readOptional<vec4>(doc, source.tangents, count, place + ", TANGENT");
  for (vec4& t : v.tangents) t = vec4(unitOr(vec3(t), vec3(0)), t.w < 0 ? -1 : 1);
  if (const size_t replaced = replaceNonFinite(v.uv0, vec2(0)) + replaceNonFinite(v.uv1, vec2(0)))
    import.counted["texture coordinate(s) that are not finite numbers, taken for 0"] += replaced;
  size_t beyond = 0; // of colours
  for (vec4& c : v.colors) {
    const vec4 given = c;
    for (int i = 0; i < 4; ++i) c[i] = c[i] >= 0 ? std::min(c[i], 1.0f) : c[i] < 0 ? 0.0f : 1.0f;
    beyond += c != given;
  }
  if (beyond) import.counted["vertex colour(s) outside of 0..1, held to it"] += beyond;
  v.jointSets = readJoints(import, source, count, place);
  for (size_t t = 0; t < source.targets.size(); ++t) {
    const std::string targetPlace = place + ", morph target " + std::to_string(t);
    MorphTarget& target = v.targets.emplace_back();
    target.positions = readOptional<vec3>(doc, source.targets[t].positions, count, targetPlace + ", POSITION");
    target.normals = readOptional<vec3>(doc, source.targets[t].normals, count, targetPlace + ", NORMAL");
    if (const size_t replaced = replaceNonFinite(target.positions, vec3(0)) + replaceNonFinite(target.normals, vec3(0)))
      import.counted["offset(s) of morph targets that are not finite numbers, taken for 0"] += replaced;
  }
  return v;
}

/// Bytes of a vertex with all that it may have.
size_t bytesPerVertex(const Vertices& v) {
  return 2 * sizeof(vec3) + 2 * sizeof(vec2) + 2 * sizeof(vec4) + v.jointSets.size() * 2 * sizeof(vec4) +
         v.targets.size() * 2 * sizeof(vec3);
}

/// Visits all arrays that a vertex has, each with the other's: fn(from's, to's).
template <class Fn> void eachArray(const Vertices& from, Vertices& to, Fn&& fn) {
  fn(from.positions, to.positions);
  fn(from.normals, to.normals);
  fn(from.uv0, to.uv0);
  fn(from.uv1, to.uv1);
  fn(from.colors, to.colors);
  fn(from.tangents, to.tangents);
  to.jointSets.resize(from.jointSets.size());
  for (size_t s = 0; s < from.jointSets.size(); ++s) {
    fn(from.jointSets[s].joints, to.jointSets[s].joints);
    fn(from.jointSets[s].weights, to.jointSets[s].weights);
  }
  to.targets.resize(from.targets.size());
  for (size_t t = 0; t < from.targets.size(); ++t) {
    fn(from.targets[t].positions, to.targets[t].positions);
    fn(from.targets[t].normals, to.targets[t].normals);
  }
}

/// Leaves out vertices that no triangle uses: an accessor may be that of many primitives.
void dropUnused(Vertices& v, std::vector<uvec3>& triangles) {
  std::vector<bool> uses(v.positions.size(), false);
  for (const uvec3& t : triangles) uses[t.x] = uses[t.y] = uses[t.z] = true;
  std::vector<uint32_t> place(uses.size(), 0), kept;
  for (uint32_t i = 0; i < uses.size(); ++i)
    if (uses[i]) place[i] = uint32_t(kept.size()), kept.push_back(i);
  if (kept.size() == uses.size()) return;
  for (uvec3& t : triangles) t = {place[t.x], place[t.y], place[t.z]};
  Vertices used;
  eachArray(v, used, [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(kept.size());
    for (const uint32_t i : kept) to.push_back(from[i]);
  });
  v = std::move(used);
}

/// Makes tangents for the material's normal map. A vertex whose triangles disagree about its tangent becomes several.
void makeTangents(const Document& doc, Vertices& v, std::vector<uvec3>& triangles, const TextureRef& map,
                  const std::string& place) {
  std::vector<vec2> uvs = map.uvSet == 0 ? v.uv0 : v.uv1;
  if (uvs.empty()) return; // the map has one texel for all, and no direction
  for (vec2& uv : uvs) uv = vec2(map.uvTransform * vec3(uv, 1));
  replaceNonFinite(uvs, vec2(0));
  replaceNonFinite(v.positions, vec3(0));         // no triangle left uses them
  constexpr size_t kBytesPerMappedTriangle = 256; // of the tangents, and of what finds neighbours meanwhile
  doc.spend(triangles.size(), kBytesPerMappedTriangle, place);
  const std::vector<CornerTangent> corners = cornerTangents(v.positions, v.normals, uvs, triangles);
  constexpr uint32_t kNobody = 0xffffffffu;
  constexpr size_t kBytesPerCopy = 64;                       // of what finds it
  std::vector<uint32_t> groups(v.positions.size(), kNobody); // of the vertices as they were read, and
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies;  // those of other groups, by vertex and group
  v.tangents.assign(v.positions.size(), vec4(0));
  for (size_t i = 0; i < corners.size(); ++i) {
    uint32_t& corner = triangles[i / 3][int(i % 3)];
    const uint32_t vertex = corner, group = corners[i].group;
    if (groups[vertex] == kNobody) {
      groups[vertex] = group;
      v.tangents[vertex] = corners[i].tangent;
    }
    if (groups[vertex] == group) continue;
    const auto [copy, added] = copies.try_emplace({vertex, group}, uint32_t(v.positions.size()));
    corner = copy->second;
    if (!added) continue;
    doc.spend(1, bytesPerVertex(v) + kBytesPerCopy, place);
    eachArray(v, v, [vertex](const auto&, auto& array) {
      if (array.empty()) return;
      const auto value = array[vertex];
      array.push_back(value);
    });
    v.tangents[corner] = corners[i].tangent;
  }
}

/// One vertex per triangle corner, each with its triangle's normal (glTF: "flat normals" where none are given).
void makeFlat(Vertices& v, std::vector<uvec3>& triangles) {
  Vertices flat;
  eachArray(v, flat, [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(triangles.size() * 3);
    for (const uvec3& t : triangles)
      for (int c = 0; c < 3; ++c) to.push_back(from[t[c]]);
  });
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    const vec3 cross = faceCross(v.positions, triangles[i]);
    const float squared = glm::dot(cross, cross); // none only where a morph or joints give the triangle its area
    const vec3 normal = squared >= std::numeric_limits<float>::min() ? glm::normalize(cross) : vec3(0, 1, 0);
    flat.normals.insert(flat.normals.end(), 3, normal);
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

/// Puts the vertices after those that the mesh has; returns the index of the first.
uint32_t appendVertices(lambent::Mesh& mesh, Vertices& v) {
  const size_t before = mesh.positions.size(), added = v.positions.size();
  for (vec3& p : v.positions)
    if (!isFinite(p)) p = vec3(0); // no triangle left uses it
  mesh.positions.insert(mesh.positions.end(), v.positions.begin(), v.positions.end());
  mesh.normals.insert(mesh.normals.end(), v.normals.begin(), v.normals.end());
  appendOptional(mesh.uv0, v.uv0, before, added, vec2(0));
  appendOptional(mesh.uv1, v.uv1, before, added, vec2(0));
  appendOptional(mesh.colors, v.colors, before, added, vec4(1));
  appendOptional(mesh.tangents, v.tangents, before, added, vec4(0));
  mesh.jointSets.resize(std::max(mesh.jointSets.size(), v.jointSets.size()));
  v.jointSets.resize(mesh.jointSets.size());
  for (size_t s = 0; s < mesh.jointSets.size(); ++s) {
    appendOptional(mesh.jointSets[s].joints, v.jointSets[s].joints, before, added, glm::uvec4(0));
    appendOptional(mesh.jointSets[s].weights, v.jointSets[s].weights, before, added, vec4(0));
  }
  mesh.morphTargets.resize(v.targets.size()); // the same in all primitives
  for (size_t t = 0; t < v.targets.size(); ++t) {
    appendOptional(mesh.morphTargets[t].positions, v.targets[t].positions, before, added, vec3(0));
    appendOptional(mesh.morphTargets[t].normals, v.targets[t].normals, before, added, vec3(0));
  }
  return uint32_t(before);
}

/// Corners of all triangles as vertex indices of the primitive. A strip's odd triangles are turned, so that all face
/// the same way.
std::vector<uvec3> readTriangles(const Document& doc, const tinygltf::Primitive& primitive, size_t vertexCount,
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
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES) {
    for (size_t i = 0; i + 2 < n; i += 3) triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
  } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
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

} // namespace

uint32_t importMesh(Import& import, int meshIndex, bool skinned) {
  const std::pair key(meshIndex, skinned);
  if (const auto known = import.meshes.find(key); known != import.meshes.end()) return known->second;
  Document& doc = import.doc;
  tinygltf::Mesh& in = doc.model.meshes[size_t(meshIndex)];
  lambent::Mesh mesh;
  mesh.name = in.name.empty() ? "mesh " + std::to_string(meshIndex) : in.name;
  HighestJoint highest;

  struct Shared { // vertices that an earlier primitive has put into the mesh, as they were read
    uint32_t first;
    std::vector<vec3> positions;
  };
  std::map<VertexSource, Shared> shared;
  for (size_t i = 0; i < in.primitives.size(); ++i) {
    tinygltf::Primitive& primitive = in.primitives[i];
    const std::string place = label("mesh", size_t(meshIndex), in.name) + ", primitive " + std::to_string(i);
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
      doc.fail(place, "mode " + std::to_string(primitive.mode) + " is not one of glTF's (0 to 6)");
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      import.counted["primitive(s) of points or lines left out"]++;
      continue;
    }
    decodePrimitive(doc, primitive, place);
    const VertexSource source = vertexSource(import, primitive, int(i), skinned);
    if (source.positions < 0) {
      import.counted["primitive(s) without positions left out"]++;
      continue;
    }
    if (source.targets.size() != in.primitives[0].targets.size())
      doc.fail(place, "has " + std::to_string(source.targets.size()) + " morph targets, but primitive 0 has " +
                          std::to_string(in.primitives[0].targets.size()));
    if (primitive.material >= 0) doc.checkIndex(primitive.material, doc.model.materials.size(), "material", place);

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
    const uint32_t material = importMaterial(import, primitive.material);
    const auto makeMissingTangents = [&] {
      const TextureRef& map = import.scene.assets.materials[material].normalTexture;
      if (source.tangentsOf >= 0 && map.image != kNone) makeTangents(doc, vertices, triangles, map, place);
    };
    uint32_t first;
    if (known != shared.end()) {
      first = known->second.first;
    } else if (flat) {
      doc.spend(3 * triangles.size(), bytesPerVertex(vertices), place);
      makeFlat(vertices, triangles);
      makeMissingTangents();
      first = appendVertices(mesh, vertices);
    } else {
      if (source.tangentsOf >= 0) dropUnused(vertices, triangles);
      doc.spend(vertices.positions.size(), bytesPerVertex(vertices), place); // what others have is filled up
      std::vector<vec3> asRead = vertices.positions;
      repairNormals(vertices, triangles);
      makeMissingTangents();
      first = appendVertices(mesh, vertices);
      shared.emplace(source, Shared{first, std::move(asRead)});
    }
    doc.spend(triangles.size(), kBytesPerTracedTriangle, place);
    appendTriangles(mesh, triangles, first, material, flat);
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
