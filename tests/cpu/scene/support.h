// Small glTF files built in memory, and a folder of its own for each test that writes.
#pragma once

#include "engine/scene/scene.h"
#include "tests/support/files.h"

#include <nlohmann/json.hpp>

namespace lambent::test {

/// A picture of one colour.
std::vector<uint8_t> png(u8vec4 color);

/// A glTF document under construction: `json` is free to edit, `bytes` is its one buffer (a data URI when written).
struct GltfBuilder {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::vector<uint8_t> bytes;

  /// Appends raw data, aligned to four bytes; returns the buffer view. `stride` 0: tightly packed.
  template <class T> int view(const std::vector<T>& data, int stride = 0) {
    while (bytes.size() % 4) bytes.push_back(0);
    nlohmann::json v = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size() * sizeof(T)}};
    if (stride) v["byteStride"] = stride;
    const auto* p = reinterpret_cast<const uint8_t*>(data.data());
    bytes.insert(bytes.end(), p, p + data.size() * sizeof(T));
    return push("bufferViews", v);
  }
  int accessor(int view, int componentType, const char* type, size_t count, size_t byteOffset = 0,
               bool normalized = false) {
    nlohmann::json a = {{"componentType", componentType}, {"type", type}, {"count", count}};
    if (view >= 0) a["bufferView"] = view;
    if (byteOffset) a["byteOffset"] = byteOffset;
    if (normalized) a["normalized"] = true;
    return push("accessors", a);
  }
  int floats(const std::vector<float>& data, const char* type = "SCALAR") {
    static const std::map<std::string, size_t> sizes{
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    return accessor(view(data), 5126, type, data.size() / sizes.at(type));
  }
  int positions(const std::vector<vec3>& p) { return accessor(view(p), 5126, "VEC3", p.size()); }
  int indices(const std::vector<uint16_t>& i) { return accessor(view(i), 5123, "SCALAR", i.size()); }

  /// A mesh of one primitive, and a node that shows it as a root of the scene; returns the node.
  int addMeshNode(const nlohmann::json& primitive) {
    const int mesh = push("meshes", {{"primitives", {primitive}}});
    return addRoot({{"mesh", mesh}});
  }
  int addRoot(const nlohmann::json& node) {
    const int n = push("nodes", node);
    if (!json.contains("scenes")) json["scenes"] = {{{"nodes", nlohmann::json::array()}}};
    json["scenes"][0]["nodes"].push_back(n);
    return n;
  }
  /// Of one channel; linear where `interpolation` is not said.
  void animate(int node, const char* path, int times, int values, const char* interpolation = nullptr);
  int push(const char* list, const nlohmann::json& item) {
    json[list].push_back(item);
    return int(json[list].size()) - 1;
  }

  std::string text() const;
  void writeGltf(const std::filesystem::path& file) const;
  void writeGlb(const std::filesystem::path& file) const;
  /// Written into `folder` and loaded.
  Scene load(const TemporaryFolder& folder, FileTrust trust = {}) const;
};

/// The right triangle (0,0,0), (1,0,0), (0,1,0), whose front is +Z, without normals.
GltfBuilder oneTriangle();

/// Whether any warning of the scene contains `text`.
bool hasWarning(const Scene& scene, const std::string& text);

void expectNear(const vec3& a, const vec3& b, float tolerance = 1e-5f);

} // namespace lambent::test
