#include "tests/fuzz/compressed.h"

#include "tests/fuzz/files.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>
#include <webp/encode.h>

#include <vector>

namespace lambent::fuzz {

namespace {

using Json = nlohmann::json;

constexpr uint32_t kSide = 4; // vertices of a grid

std::vector<vec3> gridPositions() {
  std::vector<vec3> positions;
  for (uint32_t i = 0; i < kSide * kSide; ++i) positions.emplace_back(i % kSide, 0.3f * float(i * i % 5), i / kSide);
  return positions;
}

std::vector<uint32_t> gridIndices() {
  std::vector<uint32_t> indices;
  for (uint32_t i = 0; i < kSide * (kSide - 1); ++i)
    if (i % kSide + 1 < kSide) indices.insert(indices.end(), {i, i + kSide, i + 1, i + 1, i + kSide, i + kSide + 1});
  return indices;
}

/// A .glb of one node and mesh.
std::string glbOf(Json document, const std::string& binary) {
  document["asset"]["version"] = "2.0";
  document["scenes"] = {{{"nodes", {0}}}};
  if (!document.contains("nodes")) document["nodes"] = {{{"mesh", 0}}};
  std::string text = document.dump(), data = binary;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4, '\0');
  std::string glb = "glTF";
  append<uint32_t>(glb, {2u, uint32_t(12 + 8 + text.size() + 8 + data.size()), uint32_t(text.size())});
  glb += "JSON" + text;
  append<uint32_t>(glb, {uint32_t(data.size())});
  return glb + std::string("BIN\0", 4) + data;
}

std::string dracoSeed(int method) {
  const std::vector<vec3> positions = gridPositions();
  const std::vector<uint32_t> indices = gridIndices();
  draco::TriangleSoupMeshBuilder soup;
  soup.Start(int(indices.size() / 3));
  const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = soup.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const vec3 up(0, 1, 0);
  for (uint32_t f = 0; f < indices.size() / 3; ++f) {
    const uint32_t* i = &indices[3 * f];
    soup.SetAttributeValuesForFace(position, draco::FaceIndex(f), &positions[i[0]], &positions[i[1]], &positions[i[2]]);
    soup.SetAttributeValuesForFace(normal, draco::FaceIndex(f), &up, &up, &up);
  }
  const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 8);
  draco::EncoderBuffer buffer;
  encoder.EncodeMeshToBuffer(*mesh, &buffer);
  const std::string data(buffer.data(), buffer.size());
  const size_t n = mesh->num_points();
  Json document;
  document["buffers"] = {{{"byteLength", data.size()}}};
  document["bufferViews"] = {{{"buffer", 0}, {"byteLength", data.size()}}};
  document["accessors"] = {{{"componentType", 5126}, {"type", "VEC3"}, {"count", n}},
                           {{"componentType", 5126}, {"type", "VEC3"}, {"count", n}},
                           {{"componentType", 5123}, {"type", "SCALAR"}, {"count", indices.size()}}};
  document["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}}}}}};
  document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", 0}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}};
  return glbOf(document, data);
}

std::string meshoptSeed() {
  const std::vector<vec3> positions = gridPositions();
  const std::vector<uint32_t> indices = gridIndices();
  const size_t n = positions.size();
  std::string data;
  Json document;
  size_t fallback = 0;
  const auto add = [&](std::vector<uint8_t> bytes, size_t size, const char* mode, const char* filter, size_t stride,
                       size_t count) {
    while (data.size() % 4) data += '\0';
    Json view = {{"buffer", 1}, {"byteOffset", fallback}, {"byteLength", stride * count}};
    view["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", 0},  {"byteOffset", data.size()}, {"byteLength", size}, {"byteStride", stride}, {"count", count},
        {"mode", mode}, {"filter", filter}};
    document["bufferViews"].push_back(view);
    data.append(bytes.begin(), bytes.begin() + std::ptrdiff_t(size));
    fallback += stride * count;
  };
  const auto vertices = [&](const void* values, size_t stride, const char* filter) {
    std::vector<uint8_t> bytes(meshopt_encodeVertexBufferBound(n, stride));
    const size_t size = meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values, n, stride);
    add(std::move(bytes), size, "ATTRIBUTES", filter, stride, n);
  };
  std::vector<uint8_t> packed(meshopt_encodeIndexBufferBound(indices.size(), n));
  const size_t size = meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), indices.size());
  add(std::move(packed), size, "TRIANGLES", "NONE", 4, indices.size());
  std::vector<float> exponents, up;
  for (const vec3& p : positions) exponents.insert(exponents.end(), {p.x, p.y, p.z});
  for (size_t i = 0; i < n; ++i) up.insert(up.end(), {0, 1, 0, 0});
  std::vector<uint32_t> shared(3 * n);
  meshopt_encodeFilterExp(shared.data(), n, 12, 15, exponents.data());
  vertices(shared.data(), 12, "EXPONENTIAL");
  std::vector<uint32_t> octahedral(n);
  meshopt_encodeFilterOct(octahedral.data(), n, 4, 8, up.data());
  vertices(octahedral.data(), 4, "OCTAHEDRAL");
  document["buffers"] = {{{"byteLength", data.size()}}, {{"byteLength", fallback}}};
  document["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"] = true;
  document["accessors"] = {
      {{"bufferView", 0}, {"componentType", 5125}, {"type", "SCALAR"}, {"count", indices.size()}},
      {{"bufferView", 1}, {"componentType", 5126}, {"type", "VEC3"}, {"count", n}},
      {{"bufferView", 2}, {"componentType", 5120}, {"type", "VEC3"}, {"count", n}, {"normalized", true}}};
  document["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 1}, {"NORMAL", 2}}}, {"indices", 0}}}}}};
  return glbOf(document, data);
}

/// A triangle with a picture, shown three times by instancing.
std::string webpSeed(bool lossless) {
  std::string data;
  append<float>(data, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  append<float>(data, {0, 0, 0, 2, 0, 0, 4, 0, 0});
  const size_t begin = data.size();
  std::vector<uint8_t> texels;
  for (int i = 0; i < 8 * 8 * 4; ++i) texels.push_back(uint8_t(i * i % 251));
  uint8_t* out = nullptr;
  const size_t size = lossless ? WebPEncodeLosslessRGBA(texels.data(), 8, 8, 32, &out)
                               : WebPEncodeRGBA(texels.data(), 8, 8, 32, 60, &out);
  data.append(reinterpret_cast<const char*>(out), size);
  WebPFree(out);
  Json document;
  document["buffers"] = {{{"byteLength", data.size()}}};
  document["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}},
                             {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 36}},
                             {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", size}}};
  document["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}},
                           {{"bufferView", 1}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}}};
  document["images"] = {{{"bufferView", 2}, {"mimeType", "image/webp"}}};
  document["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  document["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", 0}}}}}};
  document["nodes"] = {{{"mesh", 0}}};
  document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", 1}, {"SCALE", 0}};
  return glbOf(document, data);
}

} // namespace

std::vector<std::string> compressedSeeds() {
  return {dracoSeed(draco::MESH_EDGEBREAKER_ENCODING), dracoSeed(draco::MESH_SEQUENTIAL_ENCODING), meshoptSeed(),
          webpSeed(true), webpSeed(false)};
}

} // namespace lambent::fuzz
