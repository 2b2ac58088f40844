// Geometry and pictures that a file holds compressed are what they were, and those that are damaged or lie are refused.
#include "engine/core/error.h"
#include "tests/cpu/scene/support.h"
#include "tests/support/effort.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

namespace lambent::test::compression_test {

/// A hilly square of 9×9 vertices.
struct Hills {
  std::vector<vec3> positions, normals;
  std::vector<vec2> uv;
  std::vector<uint32_t> indices;

  Hills() {
    constexpr uint32_t n = 9;
    for (uint32_t y = 0; y < n; ++y)
      for (uint32_t x = 0; x < n; ++x) {
        positions.emplace_back(x, std::sin(float(x) + 0.7f * float(y)), y);
        normals.push_back(glm::normalize(vec3(0.1f * float(x), 1, -0.1f * float(y))));
        uv.emplace_back(float(x) / 8, float(y) / 8);
      }
    for (uint32_t y = 0; y + 1 < n; ++y)
      for (uint32_t x = 0; x + 1 < n; ++x) {
        const uint32_t i = y * n + x;
        indices.insert(indices.end(), {i, i + n, i + 1, i + 1, i + n, i + n + 1});
      }
  }
  GltfBuilder plain() const {
    GltfBuilder b;
    const int indexView = b.accessor(b.view(indices), 5125, "SCALAR", indices.size());
    b.addMeshNode({{"attributes",
                    {{"POSITION", b.positions(positions)},
                     {"NORMAL", b.positions(normals)},
                     {"TEXCOORD_0", b.accessor(b.view(uv), 5126, "VEC2", uv.size())}}},
                   {"indices", indexView}});
    return b;
  }
};

template <class T> std::vector<uint8_t> packVertices(const std::vector<T>& values) {
  std::vector<uint8_t> out(meshopt_encodeVertexBufferBound(values.size(), sizeof(T)));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), values.data(), values.size(), sizeof(T)));
  return out;
}

/// As gltfpack writes it: views of a buffer that is not there, and in each where its compressed bytes are.
GltfBuilder meshopt(const Hills& hills, const char* extension = "EXT_meshopt_compression") {
  GltfBuilder b;
  b.json["extensionsRequired"] = {extension};
  size_t fallback = 0;
  const auto packed = [&](const std::vector<uint8_t>& bytes, const char* mode, size_t stride, size_t count) {
    const int at = b.view(bytes);
    nlohmann::json& view = b.json["bufferViews"][size_t(at)];
    nlohmann::json hidden = {{"buffer", 0},
                             {"byteOffset", view["byteOffset"]},
                             {"byteLength", bytes.size()},
                             {"byteStride", stride},
                             {"count", count},
                             {"mode", mode}};
    view = {{"buffer", 1}, {"byteOffset", fallback}, {"byteLength", stride * count}};
    view["extensions"][extension] = hidden;
    fallback += stride * count;
    return at;
  };
  std::vector<uint8_t> indices(meshopt_encodeIndexBufferBound(hills.indices.size(), hills.positions.size()));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), hills.indices.data(), hills.indices.size()));
  const size_t n = hills.positions.size();
  const int index =
      b.accessor(packed(indices, "TRIANGLES", 4, hills.indices.size()), 5125, "SCALAR", hills.indices.size());
  const int positions = b.accessor(packed(packVertices(hills.positions), "ATTRIBUTES", 12, n), 5126, "VEC3", n);
  const int normals = b.accessor(packed(packVertices(hills.normals), "ATTRIBUTES", 12, n), 5126, "VEC3", n);
  const int uv = b.accessor(packed(packVertices(hills.uv), "ATTRIBUTES", 8, n), 5126, "VEC2", n);
  b.addMeshNode(
      {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uv}}}, {"indices", index}});
  b.json["extras"]["fallback"] = fallback; // for whoever writes the file
  return b;
}

Scene loadMeshopt(const GltfBuilder& b, const TemporaryFolder& folder, bool binary,
                  const char* extension = "EXT_meshopt_compression") {
  const fs::path file = folder / (binary ? "scene.glb" : "scene.gltf");
  nlohmann::json json = nlohmann::json::parse(b.text());
  if (binary) json["buffers"] = {{{"byteLength", b.bytes.size()}}};
  nlohmann::json fallback = {{"byteLength", json["extras"]["fallback"]}};
  fallback["extensions"][extension]["fallback"] = true;
  json["buffers"].push_back(fallback);
  GltfBuilder whole = b;
  whole.json = json;
  if (binary)
    whole.writeGlb(file);
  else
    writeBytes(file, json.dump());
  return loadScene(file);
}

GltfBuilder draco(const Hills& hills, bool sequential, int bits) {
  draco::TriangleSoupMeshBuilder soup;
  soup.Start(int(hills.indices.size() / 3));
  const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = soup.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = soup.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (uint32_t f = 0; f < hills.indices.size() / 3; ++f) {
    const uint32_t* i = &hills.indices[3 * f];
    const draco::FaceIndex face(f);
    const auto& p = hills.positions;
    const auto& n = hills.normals;
    soup.SetAttributeValuesForFace(position, face, &p[i[0]], &p[i[1]], &p[i[2]]);
    soup.SetAttributeValuesForFace(normal, face, &n[i[0]], &n[i[1]], &n[i[2]]);
    soup.SetAttributeValuesForFace(uv, face, &hills.uv[i[0]], &hills.uv[i[1]], &hills.uv[i[2]]);
  }
  const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
  if (bits > 0)
    for (const auto type :
         {draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL, draco::GeometryAttribute::TEX_COORD})
      encoder.SetAttributeQuantization(type, bits);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  GltfBuilder b;
  b.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const int view = b.view(std::vector<uint8_t>(buffer.data(), buffer.data() + buffer.size()));
  const size_t n = mesh->num_points();
  nlohmann::json primitive = {{"attributes",
                               {{"POSITION", b.accessor(-1, 5126, "VEC3", n)},
                                {"NORMAL", b.accessor(-1, 5126, "VEC3", n)},
                                {"TEXCOORD_0", b.accessor(-1, 5126, "VEC2", n)}}},
                              {"indices", b.accessor(-1, 5123, "SCALAR", hills.indices.size())}};
  primitive["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  b.addMeshNode(primitive);
  return b;
}

/// The corners of triangles, whatever the order of triangles, of their corners and of vertices, each with what it has.
std::multiset<std::string> cornersOf(const Mesh& mesh, float grain) {
  std::multiset<std::string> out;
  const auto rounded = [&](float v) { return std::to_string(std::lround(v / grain)) + " "; };
  for (const uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const vec3 p = mesh.positions[t[c]], n = mesh.normals[t[c]];
      const vec2 uv = mesh.uv0[t[c]];
      out.insert(rounded(p.x) + rounded(p.z) + rounded(uv.x) + rounded(uv.y) + (n.y > 0 ? "up" : "down"));
    }
  return out;
}

void expectHills(const Scene& scene, const Hills& hills, float grain = 1e-3f) {
  const TemporaryFolder folder;
  const Scene plain = hills.plain().load(folder);
  ASSERT_EQ(scene.assets.meshes.size(), 1u);
  EXPECT_EQ(cornersOf(scene.assets.meshes[0], grain), cornersOf(plain.assets.meshes[0], grain));
  expectNear(scene.assets.meshes[0].boundsObject.lo, plain.assets.meshes[0].boundsObject.lo, grain);
  expectNear(scene.assets.meshes[0].boundsObject.hi, plain.assets.meshes[0].boundsObject.hi, grain);
}

/// Why a scene is refused; empty where it is not.
std::string refusal(const std::function<void()>& load) {
  try {
    load();
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(Compression, MeshoptIsWhatItWas) {
  const Hills hills;
  const TemporaryFolder folder;
  for (const bool binary : {false, true}) expectHills(loadMeshopt(meshopt(hills), folder, binary), hills);
  constexpr const char* kKhr = "KHR_meshopt_compression";
  expectHills(loadMeshopt(meshopt(hills, kKhr), folder, true, kKhr), hills);
}

TEST(Compression, MeshoptFiltersAreUndone) {
  Hills hills;
  for (vec3& n : hills.normals) n = vec3(0, 1, 0);
  GltfBuilder b = meshopt(hills);
  std::vector<float> four;
  for (const vec3& n : hills.normals) four.insert(four.end(), {n.x, n.y, n.z, 0});
  std::vector<glm::i8vec4> packed(hills.normals.size());
  meshopt_encodeFilterOct(packed.data(), packed.size(), 4, 8, four.data());
  const std::vector<uint8_t> bytes = packVertices(packed);
  const int raw = b.view(bytes);
  nlohmann::json& view = b.json["bufferViews"][size_t(b.json["accessors"][2]["bufferView"])];
  view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", b.json["bufferViews"][size_t(raw)]["byteOffset"]},
                                                   {"byteLength", bytes.size()},
                                                   {"byteStride", 4},
                                                   {"count", packed.size()},
                                                   {"mode", "ATTRIBUTES"},
                                                   {"filter", "OCTAHEDRAL"}};
  view["byteStride"] = 4;
  b.json["accessors"][2]["componentType"] = 5120;
  b.json["accessors"][2]["normalized"] = true;
  const TemporaryFolder folder;
  const Scene scene = loadMeshopt(b, folder, false);
  for (const vec3& n : scene.assets.meshes[0].normals) expectNear(n, {0, 1, 0}, 0.01f);
}

TEST(Compression, DamagedMeshoptIsRefusedWhereItIsUsed) {
  const Hills hills;
  const TemporaryFolder folder;
  const auto with = [&](const char* key, const nlohmann::json& value) {
    GltfBuilder b = meshopt(hills);
    b.json["bufferViews"][1]["extensions"]["EXT_meshopt_compression"][key] = value;
    return refusal([&] { loadMeshopt(b, folder, false); });
  };
  EXPECT_NE(with("byteLength", 20).find("damaged"), std::string::npos);
  EXPECT_NE(with("byteLength", 1 << 20).find("past the end"), std::string::npos);
  EXPECT_NE(with("byteStride", 10).find("byteStride 10"), std::string::npos);
  EXPECT_NE(with("mode", "ANY").find("'ANY'"), std::string::npos);
  EXPECT_NE(with("filter", "ANY").find("'ANY'"), std::string::npos);
  EXPECT_NE(with("buffer", 7).find("buffer"), std::string::npos);
  EXPECT_NE(with("count", -1).find("whole number"), std::string::npos);
  EXPECT_NE(with("count", 400000000).find("more memory"), std::string::npos);
  // What nothing uses does no harm.
  GltfBuilder b = meshopt(hills);
  b.json["bufferViews"].push_back(b.json["bufferViews"][1]);
  b.json["bufferViews"].back()["extensions"]["EXT_meshopt_compression"]["mode"] = "ANY";
  expectHills(loadMeshopt(b, folder, false), hills);
}

TEST(Compression, DracoIsWhatItWas) {
  const Hills hills;
  const TemporaryFolder folder;
  for (const bool sequential : {true, false}) {
    expectHills(draco(hills, sequential, 0).load(folder), hills);
    expectHills(draco(hills, sequential, 14).load(folder), hills, 0.022f);
  }
}

/// Sparse values are put over what was decoded, and a file may hold both spellings of itself.
TEST(Compression, DracoBesidePlainDataGivesWay) {
  const Hills hills;
  const TemporaryFolder folder;
  GltfBuilder b = draco(hills, true, 0);
  nlohmann::json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["attributes"] = {{"POSITION", b.positions(hills.positions)},
                             {"NORMAL", b.positions(hills.normals)},
                             {"TEXCOORD_0", b.accessor(b.view(hills.uv), 5126, "VEC2", hills.uv.size())}};
  primitive["indices"] = b.accessor(b.view(hills.indices), 5125, "SCALAR", hills.indices.size());
  for (int i = 0; i < 20; ++i) b.bytes[size_t(i)] = 0; // the compressed ones are never looked at
  expectHills(b.load(folder), hills);
}

/// As exporters write what two meshes or materials share: the second is not decoded again, and has the same triangles.
TEST(Compression, DracoOfTwoMeshesIsWhole) {
  const TemporaryFolder folder;
  const Hills hills;
  GltfBuilder b = draco(hills, false, 0);
  nlohmann::json primitive = b.json["meshes"][0]["primitives"][0];
  b.json["materials"] = {{{"name", "other"}}};
  primitive["material"] = 0;
  b.json["meshes"][0]["primitives"].push_back(primitive);
  b.addMeshNode(primitive);
  const Scene scene = b.load(folder);
  ASSERT_EQ(scene.assets.meshes.size(), 2u);
  const size_t triangles = hills.indices.size() / 3;
  EXPECT_EQ(scene.assets.meshes[0].triangles.size(), 2 * triangles);
  EXPECT_EQ(cornersOf(scene.assets.meshes[1], 1e-4f).size(), 3 * triangles);
  Mesh second = scene.assets.meshes[0];
  second.triangles.erase(second.triangles.begin(), second.triangles.begin() + ptrdiff_t(triangles));
  EXPECT_EQ(cornersOf(second, 1e-4f), cornersOf(scene.assets.meshes[1], 1e-4f));
  second = scene.assets.meshes[0];
  second.triangles.resize(triangles);
  EXPECT_EQ(cornersOf(second, 1e-4f), cornersOf(scene.assets.meshes[1], 1e-4f));
}

TEST(Compression, DracoThatLiesIsRefused) {
  const Hills hills;
  const TemporaryFolder folder;
  const auto refused = [&](const std::function<void(GltfBuilder&)>& change, bool sequential = false) {
    GltfBuilder b = draco(hills, sequential, 14);
    change(b);
    return refusal([&] { b.load(folder); });
  };
  EXPECT_EQ(refused([](GltfBuilder&) {}), "");
  EXPECT_NE(refused([](GltfBuilder& b) { b.bytes[0] = 'X'; }).find("bitstream"), std::string::npos);
  EXPECT_NE(
      refused([](GltfBuilder& b) { b.bytes.resize(40), b.json["bufferViews"][0]["byteLength"] = 40; }).find("damaged"),
      std::string::npos);
  for (const bool sequential : {true, false})
    EXPECT_NE(refused(
                  [](GltfBuilder& b) {
                    for (int i = 0; i < 3; ++i) b.json["accessors"][size_t(i)]["count"] = 3;
                  },
                  sequential)
                  .find("81 vertices"),
              std::string::npos);
  EXPECT_NE(refused([](GltfBuilder& b) { b.json["accessors"][1]["count"] = 80; }).find("81 vertices"),
            std::string::npos);
  EXPECT_NE(refused([](GltfBuilder& b) { b.json["accessors"][2]["type"] = "VEC3"; }).find("components"),
            std::string::npos);
  EXPECT_NE(refused([](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["mode"] = 5; }).find("triangles"),
            std::string::npos);
  const auto extension = [](GltfBuilder& b) -> nlohmann::json& {
    return b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  };
  EXPECT_NE(refused([&](GltfBuilder& b) { extension(b)["attributes"]["NORMAL"] = 9; }).find("attribute 9"),
            std::string::npos);
  EXPECT_NE(refused([&](GltfBuilder& b) { extension(b)["bufferView"] = 9; }).find("buffer view 9"), std::string::npos);
}

/// Attributes that no accessor names would take as much memory as those that one does: 255 of 255 values a vertex are a
/// kilobyte of the file. The stream ends where their values would begin.
TEST(Compression, DracoAttributesAreCountedBeforeTheyAreDecoded) {
  constexpr uint8_t kMost = 255;
  constexpr size_t kPoints = 20000, kFaces = 7000;
  std::vector<uint8_t> stream{'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0}; // 2.2, a mesh, sequential
  const auto number = [&](size_t n) {
    for (; n > 127; n >>= 7) stream.push_back(uint8_t(n & 127) | 128);
    stream.push_back(uint8_t(n));
  };
  number(kFaces);
  number(kPoints);
  stream.push_back(1);                        // corners follow, two bytes each
  stream.insert(stream.end(), 6 * kFaces, 0); //
  stream.push_back(1);                        // decoder, of so many attributes
  number(kMost);
  for (uint8_t i = 0; i < kMost; ++i) {
    stream.insert(stream.end(), {uint8_t(i == 0 ? 0 : 4), 2, kMost, 0}); // what for, bytes, width
    number(i);
  }
  stream.insert(stream.end(), kMost, 0); // how each is stored
  GltfBuilder b;
  const int view = b.view(stream);
  nlohmann::json primitive = {{"attributes", {{"POSITION", b.accessor(-1, 5126, "VEC3", kPoints)}}},
                              {"indices", b.accessor(-1, 5123, "SCALAR", 3)}};
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  b.addMeshNode(primitive);
  const TemporaryFolder folder;
  const std::string why = refusal([&] { b.load(folder); });
  EXPECT_NE(why.find("Draco: needs more memory than a file of"), std::string::npos) << why;
}

/// Attributes of 18 bytes build tables of a million entries, and one may name 64 symbols for each of its bytes: neither
/// is counted by what it brings.
TEST(Compression, DracoIsHeldToWhatItsSizeExplains) {
  const auto number = [](std::vector<uint8_t>& to, size_t n) {
    for (; n > 127; n >>= 7) to.push_back(uint8_t(n & 127) | 128);
    to.push_back(uint8_t(n));
  };
  const auto refusalOf = [&](size_t attributes, const std::vector<uint8_t>& symbols, bool large = false) {
    std::vector<uint8_t> stream{'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0,
                                0,   0,   1,   3,   1,   0, 1, 2, 1}; // a triangle, a decoder
    number(stream, 1 + attributes);
    stream.insert(stream.end(), {0, 9, 3, 0, 0}); // positions, three floats
    for (size_t i = 0; i < attributes; ++i) {
      stream.insert(stream.end(), {4, 5, 1, 0}); // an integer
      number(stream, i + 1);
    }
    stream.push_back(0); // positions as they are, integers as symbols
    stream.insert(stream.end(), attributes, 1);
    stream.insert(stream.end(), 36, 0);
    for (size_t i = 0; i < attributes; ++i) {
      stream.insert(stream.end(), {0xfe, 1});
      stream.insert(stream.end(), symbols.begin(), symbols.end());
    }
    GltfBuilder b;
    const int view = b.view(stream);
    nlohmann::json primitive = {{"attributes", {{"POSITION", b.accessor(-1, 5126, "VEC3", 3)}}}};
    primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
    b.addMeshNode(primitive);
    const TemporaryFolder folder;
    return refusal([&] { b.load(folder, {.large = large}); });
  };
  const std::vector<uint8_t> wide{1, 18, 1, 2, 0, 0x40, 1, 0}; // 18 bits, a symbol that is certain, no bits of values
  EXPECT_EQ(refusalOf(5, wide), "");
  const std::string many = refusalOf(26000, wide);
  EXPECT_NE(many.find("attributes that are decoded to 26001"), std::string::npos) << many;
  SKIP_STATISTICS_WHEN_SANITIZED(); // which end a program that gets no memory
  constexpr size_t kBytes = 2800000;
  std::vector<uint8_t> named{1, 18};
  number(named, 64 * kBytes);
  named.insert(named.end(), kBytes, 255);
  const std::string symbols = refusalOf(1, named);
  EXPECT_NE(symbols.find("needs more memory than a file of"), std::string::npos) << symbols;
  EXPECT_NO_THROW(std::vector<char>(size_t(1) << 30)) << "the limit has gone";
}

/// Nor may edgebreaker's decoders of attributes, of which each has a table of all corners. The stream ends there.
TEST(Compression, DracoTablesAreCountedBeforeTheyAreMade) {
  constexpr size_t kFaces = 100000;
  std::vector<uint8_t> stream{'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 0}; // 2.2, a mesh, edgebreaker, standard
  for (const size_t n : {size_t(1000), kFaces}) {
    size_t rest = n;
    for (; rest > 127; rest >>= 7) stream.push_back(uint8_t(rest & 127) | 128);
    stream.push_back(uint8_t(rest));
  }
  stream.push_back(254);
  GltfBuilder b;
  const int view = b.view(stream);
  nlohmann::json primitive = {{"attributes", {{"POSITION", b.accessor(-1, 5126, "VEC3", 1000)}}},
                              {"indices", b.accessor(-1, 5125, "SCALAR", 3 * kFaces)}};
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  b.addMeshNode(primitive);
  const TemporaryFolder folder;
  const std::string why = refusal([&] { b.load(folder); });
  EXPECT_NE(why.find("Draco: needs more memory than a file of"), std::string::npos) << why;
}

/// A picture may be small and take long to decode: one that many entries name is decoded once.
TEST(Compression, PicturesOfSeveralEntriesAreDecodedOnce) {
  const Hills hills;
  GltfBuilder b = hills.plain();
  const int view = b.view(png({255, 0, 188, 255}));
  for (int i = 0; i < 5; ++i) {
    b.push("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    b.push("textures", {{"source", i}});
    b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    b.addMeshNode({{"attributes", b.json["meshes"][0]["primitives"][0]["attributes"]}, {"material", i}});
  }
  const Scene scene = b.load(TemporaryFolder());
  EXPECT_EQ(scene.assets.materials.size(), 6u);
  EXPECT_EQ(scene.assets.images.size(), 1u);
}

/// One whose tables might be large is decoded by itself, and is what it was.
TEST(Compression, LargeWebpIsDecoded) {
  constexpr int kSide = 512;
  std::vector<uint8_t> texels;
  for (uint32_t i = 0; i < kSide * kSide; ++i)
    for (uint32_t c = 0; c < 4; ++c) texels.push_back(c == 3 ? 255 : uint8_t(Rng(1, Stream::Test, i, c).next() * 256));
  uint8_t* out = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(texels.data(), kSide, kSide, 4 * kSide, &out);
  ASSERT_GT(size, 100000u);
  GltfBuilder b = Hills().plain();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["images"] = {{{"bufferView", b.view(std::vector<uint8_t>(out, out + size))}, {"mimeType", "image/webp"}}};
  WebPFree(out);
  b.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  const Scene scene = b.load(TemporaryFolder());
  const TextureImage& image = scene.assets.images.at(0);
  ASSERT_EQ(image.texels.size(), size_t(kSide * kSide));
  EXPECT_EQ(std::memcmp(image.texels.data(), texels.data(), texels.size()), 0);
}

TEST(Compression, WebpIsDecoded) {
  std::vector<uint8_t> texels;
  for (int i = 0; i < 16; ++i)
    for (const int c : {16 * i, 255 - 16 * i, i % 2 ? 255 : 0, 255 - i}) texels.push_back(uint8_t(c));
  uint8_t* out = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(texels.data(), 4, 4, 16, &out);
  ASSERT_GT(size, 0u);
  std::vector<uint8_t> file(out, out + size);
  WebPFree(out);
  const TemporaryFolder folder;
  const auto scene = [&](const std::vector<uint8_t>& bytes) {
    GltfBuilder b = oneTriangle();
    b.json["extensionsRequired"] = {"EXT_texture_webp"};
    b.json["images"] = {{{"mimeType", "image/webp"}, {"bufferView", b.view(bytes)}}};
    b.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    return b.load(folder);
  };
  const Scene good = scene(file);
  ASSERT_EQ(good.assets.images.size(), 1u);
  ASSERT_EQ(good.assets.images[0].width, 4);
  for (size_t i = 0; i < 16; ++i)
    for (int c = 0; c < 4; ++c) EXPECT_EQ(good.assets.images[0].texels[i][c], texels[4 * i + size_t(c)]);
  file.resize(size / 2);
  EXPECT_TRUE(hasWarning(scene(file), "WebP"));
}

TEST(Compression, Ktx2IsNamedWithWhatConvertsIt) {
  const TemporaryFolder folder;
  GltfBuilder b = oneTriangle();
  b.json["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_TRUE(hasWarning(b.load(folder), "ktxdecompress"));
  b.json["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_NE(refusal([&] { b.load(folder); }).find("ktxdecompress"), std::string::npos);
}

// Instances ----------------------------------------------------------------------------------------------------------

TEST(Instancing, EachStandsWhereItIsSaid) {
  const TemporaryFolder folder;
  GltfBuilder b = oneTriangle();
  b.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  nlohmann::json& node = b.json["nodes"][0];
  node["translation"] = {0, 10, 0};
  const int translations = b.positions({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  const int scales = b.positions({{1, 1, 1}, {2, 2, 2}, {1, -1, 1}});
  const int rotations = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f}, "VEC4");
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", translations}, {"SCALE", scales}, {"ROTATION", rotations}};
  const Scene scene = b.load(folder);
  SceneExtractor extractor;
  const SceneView view = extractor.extract(scene, {}, 0);
  ASSERT_EQ(view.instances.size(), 3u);
  expectNear(vec3(view.instances[0].worldFromObject[3]), {1, 10, 0});
  expectNear(vec3(view.instances[1].worldFromObject * vec4(1, 0, 0, 1)), {4, 10, 0});
  expectNear(vec3(view.instances[2].worldFromObject * vec4(1, 0, 0, 1)), {3, 11, 0});
  expectNear(vec3(view.instances[2].worldFromObject * vec4(0, 1, 0, 1)), {4, 10, 0});

  const auto refused = [&](const char* name, int accessor) {
    GltfBuilder bad = b;
    bad.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][name] = accessor;
    return refusal([&] { bad.load(folder); });
  };
  EXPECT_NE(refused("SCALE", b.positions({{1, 1, 1}})).find("1 elements"), std::string::npos);
  EXPECT_NE(refused("SCALE", 99).find("accessor 99"), std::string::npos);
  EXPECT_NE(refused("TRANSLATION", b.positions({{0, 0, 0}, {NAN, 0, 0}, {0, 0, 0}})).find("finite"), std::string::npos);
  EXPECT_NE(refused("TRANSLATION", b.accessor(-1, 5126, "VEC3", 4000000)).find("elements"), std::string::npos);
  GltfBuilder many = oneTriangle();
  many.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      many.accessor(-1, 5126, "VEC3", 4000000);
  EXPECT_NE(refusal([&] { many.load(folder); }).find("memory"), std::string::npos);
  // So do many nodes that share their transforms: a file of 0.2 MB took 39 s.
  GltfBuilder shared = oneTriangle();
  shared.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      shared.accessor(-1, 5126, "VEC3", 20000);
  for (int i = 1; i < 25; ++i) {
    shared.json["nodes"].push_back(shared.json["nodes"][0]);
    shared.json["scenes"][0]["nodes"].push_back(i);
  }
  EXPECT_NE(refusal([&] { shared.load(folder); }).find("memory"), std::string::npos);
}

} // namespace lambent::test::compression_test
