#include "engine/scene/gltf_vertices.h"

#include <cmath>

namespace lambent::gltf {

namespace {

int find(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

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

} // namespace

VertexSource vertexSource(Import& import, const Primitive& primitive, bool skinned) {
  const auto& given = primitive.attributes;
  VertexSource source;
  source.positions = find(given, "POSITION");
  source.normals = find(given, "NORMAL");
  source.uv0 = find(given, "TEXCOORD_0");
  source.uv1 = find(given, "TEXCOORD_1");
  source.colors = find(given, "COLOR_0");
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
  replaceNonFinite(v.uv0, vec2(0));
  replaceNonFinite(v.uv1, vec2(0));
  replaceNonFinite(v.colors, vec4(1));
  v.jointSets = readJoints(import, source, count, place);
  for (size_t t = 0; t < source.targets.size(); ++t) {
    const std::string targetPlace = place + ", morph target " + std::to_string(t);
    MorphTarget& target = v.targets.emplace_back();
    target.positions = readOptional<vec3>(doc, source.targets[t].positions, count, targetPlace + ", POSITION");
    target.normals = readOptional<vec3>(doc, source.targets[t].normals, count, targetPlace + ", NORMAL");
    replaceNonFinite(target.positions, vec3(0));
    replaceNonFinite(target.normals, vec3(0));
  }
  return v;
}

void makeFlat(Vertices& v, std::vector<uvec3>& triangles) {
  Vertices flat;
  const auto unweld = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(triangles.size() * 3);
    for (const uvec3& t : triangles)
      for (int c = 0; c < 3; ++c) to.push_back(from[t[c]]);
  };
  unweld(v.positions, flat.positions);
  unweld(v.uv0, flat.uv0);
  unweld(v.uv1, flat.uv1);
  unweld(v.colors, flat.colors);
  for (const JointSet& set : v.jointSets) {
    JointSet& to = flat.jointSets.emplace_back();
    unweld(set.joints, to.joints);
    unweld(set.weights, to.weights);
  }
  for (const MorphTarget& target : v.targets) unweld(target.positions, flat.targets.emplace_back().positions);
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    const vec3 cross = faceCross(v.positions, triangles[i]);
    const float squared = glm::dot(cross, cross); // none only where a morph or joints give the triangle its area
    const vec3 normal = squared >= std::numeric_limits<float>::min() ? glm::normalize(cross) : vec3(0, 1, 0);
    flat.normals.insert(flat.normals.end(), 3, normal);
    triangles[i] = uvec3(3 * i, 3 * i + 1, 3 * i + 2);
  }
  v = std::move(flat);
}

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

uint32_t appendVertices(lambent::Mesh& mesh, Vertices& v) {
  const size_t before = mesh.positions.size(), added = v.positions.size();
  for (vec3& p : v.positions)
    if (!isFinite(p)) p = vec3(0); // no triangle left uses it
  mesh.positions.insert(mesh.positions.end(), v.positions.begin(), v.positions.end());
  mesh.normals.insert(mesh.normals.end(), v.normals.begin(), v.normals.end());
  appendOptional(mesh.uv0, v.uv0, before, added, vec2(0));
  appendOptional(mesh.uv1, v.uv1, before, added, vec2(0));
  appendOptional(mesh.colors, v.colors, before, added, vec4(1));
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

} // namespace lambent::gltf
