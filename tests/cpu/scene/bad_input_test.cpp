// Files with defects: each gives an InputError that names the file and the place, or loads with a warning; none
// crashes.

#include "engine/scene/gltf_document.h"
#include "tests/cpu/scene/support.h"
#include "tests/support/effort.h"

namespace lambent::test::bad_input_test {

using nlohmann::json;

class BadInput : public ::testing::Test {
 protected:
  /// Loads the file and expects an error that names the file and contains `reason`.
  void expectError(const GltfBuilder& b, const std::string& reason) {
    b.writeGltf(folder / "bad.gltf");
    expectError(folder / "bad.gltf", reason);
  }
  void expectError(const fs::path& file, const std::string& reason) {
    SCOPED_TRACE(reason);
    const std::string error = inputErrorOf([&] { loadScene(file); });
    EXPECT_EQ(error.rfind(file.string() + ": ", 0), 0u) << error;
    EXPECT_NE(error.find(reason), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }

  void expectError(const std::string& name, const std::string& bytes, const std::string& reason) {
    writeBytes(folder / name, bytes);
    expectError(folder / name, reason);
  }

  TemporaryFolder folder;
};

TEST_F(BadInput, MissingEmptyAndForeignFiles) {
  expectError(folder / "none.gltf", "no such file");
  expectError(folder.path(), "is not a file");
  expectError("empty.gltf", "", "is empty");
  expectError("words.gltf", "these are words", "line 1");
  expectError("array.gltf", "[1, 2, 3]", "not a JSON object");
  expectError("nested.gltf", std::string(100000, '['), "nested");
  GltfBuilder old = oneTriangle();
  old.json["asset"]["version"] = "1.0";
  expectError(old, "2.0 expected");
}

TEST_F(BadInput, BinaryFilesCutOffAnywhereAreRefused) {
  oneTriangle().writeGlb(folder / "whole.glb");
  const std::string whole = readBytes(folder / "whole.glb");
  for (size_t size = 4; size < whole.size(); size += 3) expectError("cut.glb", whole.substr(0, size), "cut off");
  std::string longChunk = whole;
  longChunk[12] = char(0xff); // length of the JSON chunk
  longChunk[14] = char(0xff);
  expectError("chunk.glb", longChunk, "chunk 0");
  // A header that says too little, before a chunk that says too much.
  for (int length = 0; length < 20; ++length) {
    std::string shortHeader = whole;
    shortHeader.replace(8, 8, {char(length), 0, 0, 0, char(0xf0), char(0xff), char(0xff), char(0xff)});
    expectError("short.glb", shortHeader, "cut off");
  }
  // One that claims a few bytes more than the file has after it.
  std::string lastChunk = whole;
  lastChunk[whole.size() - 36 - 8] = 40;
  expectError("last.glb", lastChunk, "chunk 1");
  for (size_t more = 1; more < 8; ++more) { // a third chunk, without all of its header
    std::string header = whole + std::string(more, '\0');
    header[8] = char(header.size() & 0xff);
    header[9] = char(header.size() >> 8);
    expectError("header.glb", header, "within the header of chunk 2");
  }
}

TEST_F(BadInput, IndicesOutOfRangeNameTheirPlace) {
  GltfBuilder vertex;
  const int positions = vertex.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  vertex.addMeshNode({{"attributes", {{"POSITION", positions}}}, {"indices", vertex.indices({0, 1, 7})}});
  vertex.json["meshes"][0]["name"] = "Wall";
  expectError(vertex, "mesh 0 'Wall', primitive 0, indices, accessor 1: index 7 at 2");

  struct Case {
    json::json_pointer at;
    json value;
    std::string reason;
  };
  const std::vector<Case> cases = {
      {"/meshes/0/primitives/0/attributes/POSITION"_json_pointer, 9, "refers to accessor 9"},
      {"/meshes/0/primitives/0/indices"_json_pointer, 99, "accessor"},
      {"/meshes/0/primitives/0/material"_json_pointer, 4, "refers to material 4, but the file has none"},
      {"/meshes/0/primitives/0/mode"_json_pointer, 12, "mode 12"},
      {"/accessors/0/bufferView"_json_pointer, 5, "refers to buffer view 5"},
      {"/accessors/0/count"_json_pointer, 4, "run past the end of buffer view 0"},
      {"/accessors/0/count"_json_pointer, 4611686018427387904ull, "accessor 0"},
      {"/accessors/0/byteOffset"_json_pointer, 18446744073709551604ull, "run past the end"},
      {"/accessors/0/type"_json_pointer, "VEC2", "2 components (3 expected)"},
      {"/accessors/0/componentType"_json_pointer, 5124, "component type 5124"},
      {"/bufferViews/0/buffer"_json_pointer, 3, "refers to buffer 3"},
      {"/bufferViews/0/byteLength"_json_pointer, 4096, "runs past the end of buffer 0"},
      {"/bufferViews/0/byteOffset"_json_pointer, 18446744073709551615ull, "runs past the end of buffer 0"},
      {"/nodes/0/mesh"_json_pointer, 2, "node 0: refers to mesh 2"},
      {"/nodes/0/camera"_json_pointer, 0, "refers to camera 0"},
      {"/nodes/0/skin"_json_pointer, 0, "refers to skin 0"},
      {"/nodes/0/children"_json_pointer, json{8}, "refers to node 8"},
      {"/nodes/0/extensions"_json_pointer, json{{"KHR_lights_punctual", {{"light", 3}}}}, "refers to light 3"},
      {"/scenes/0/nodes"_json_pointer, json{5}, "refers to node 5"},
      {"/scene"_json_pointer, 6, "refers to scene 6"},
      {"/nodes/0/scale"_json_pointer, json{1, 2}, "2 numbers (3 expected)"},
      {"/nodes/0/translation"_json_pointer, json{1, 2, 1e300}, "single precision"},
      {"/extensionsRequired"_json_pointer, json{"KHR_materials_transmission"}, "KHR_materials_transmission"},
  };
  for (const Case& c : cases) {
    GltfBuilder b = oneTriangle();
    b.json[c.at] = c.value;
    expectError(b, c.reason);
  }
}

TEST_F(BadInput, TexturesAndPictures) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  expectError(b, "refers to texture 0, but the file has none");
  b.json["textures"] = {{{"source", 0}, {"sampler", 2}}};
  b.json["images"] = {{{"uri", "missing.png"}}};
  expectError(b, "refers to sampler 2");
  b.json["textures"][0].erase("sampler");
  const auto expectWhite = [&](const std::string& reason) {
    const Scene scene = b.load(folder);
    EXPECT_TRUE(hasWarning(scene, "image 0 'missing.png': " + reason)) << reason;
    EXPECT_EQ(sampleTexture(scene.assets, scene.assets.materials.at(0).baseColorTexture, vec2(0.3f)), vec4(1));
  };
  // Each pass over a picture of 8192 x 8192 takes 4 ms, and 12 bytes.
  std::string passes("\xff\xd8\xff\xc2\x00\x0b\x08\x20\x00\x20\x00\x01\x01\x11\x00", 15);
  for (int i = 0; i < 2000; ++i) passes += std::string("\xff\xda\x00\x08\x01\x01\x00\x01\x01\x00", 10);
  writeBytes(folder / "missing.png", passes);
  expectWhite("is a JPEG of 2000 passes");
  // Several together take as long as one: half of what one may take each, and the third is too much.
  GltfBuilder several = b;
  std::string half("\xff\xd8\xff\xc2\x00\x0b\x08\x04\x00\x04\x00\x01\x01\x11\x00", 15); // 1024 each way
  for (int i = 0; i < 4000; ++i) half += std::string("\xff\xda\x00\x08\x01\x01\x00\x01\x01\x00", 10);
  const auto halfOf = [](int i) { return "half" + std::to_string(i) + ".jpg"; };
  for (int i = 0; i < 3; ++i) {
    writeBytes(folder / halfOf(i), half);
    several.json["images"][size_t(i)] = {{"uri", halfOf(i)}};
    several.json["textures"][size_t(i)] = {{"source", i}};
    several.json["materials"][size_t(i)] = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}};
    several.json["meshes"][0]["primitives"][size_t(i)] = several.json["meshes"][0]["primitives"][0];
    several.json["meshes"][0]["primitives"][size_t(i)]["material"] = i;
  }
  const Scene scene = several.load(folder);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(hasWarning(scene, "image " + std::to_string(i) + " '" + halfOf(i) + "': is a JPEG of 4000 passes"),
              i == 2);
  // One of a few adds them up in memory of its own: 16 bytes a texel.
  std::string large("\xff\xd8\xff\xc2\x00\x0b\x08\x18\x00\x18\x00\x01\x01\x11\x00", 15); // 6144 each way
  for (int i = 0; i < 2; ++i) large += std::string("\xff\xda\x00\x08\x01\x01\x00\x01\x01\x00", 10);
  writeBytes(folder / "missing.png", large);
  expectError(b, "needs more memory than a file of");
  std::filesystem::remove(folder / "missing.png");
  expectWhite("cannot be read");
  writeBytes(folder / "missing.png", "no picture");
  expectWhite("cannot be decoded");
  // What the library reads beyond glTF's kinds: of a .hdr whose run is cut off it never finds the end.
  writeBytes(folder / "missing.png",
             std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\x00\x08\x88", 50));
  expectWhite("cannot be decoded: unknown image type");
  // The header of a PNG of 20000×1 and of one beyond any memory.
  const std::string header("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x4e\x20\0\0\0\x01\x08\x02\0\0\0\0\0\0\0", 33);
  writeBytes(folder / "missing.png", header);
  expectWhite("is 20000x1 texels");
  large = header;
  large.replace(16, 8, std::string("\0\0\x40\0\0\0\x40\0", 8)); // 16384 each way
  writeBytes(folder / "missing.png", large);
  expectError(b, "needs more memory than a file of");
  b.json["images"] = {{{"bufferView", 44}, {"mimeType", "image/png"}}};
  expectError(b, "bufferView");
  b.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 100000}, {"byteLength", 8}});
  b.json["images"] = {{{"bufferView", 1}, {"mimeType", "image/png"}}};
  expectError(b, "runs past the end of buffer 0");
}

TEST_F(BadInput, ExternalBufferMissingOrShort) {
  json j = json::parse(oneTriangle().text());
  j["buffers"][0]["uri"] = "data.bin";
  expectError("bad.gltf", j.dump(), "data.bin");
  writeBytes(folder / "data.bin", "short");
  expectError(folder / "bad.gltf", "data.bin");
}

TEST_F(BadInput, PathsAreNotExpandedByAShell) {
  json j = json::parse(oneTriangle().text());
  const fs::path trap = folder / "trap";
  j["buffers"][0]["uri"] = "$(touch " + trap.string() + ")";
  expectError("bad.gltf", j.dump(), "not found");
  EXPECT_FALSE(fs::exists(trap));
}

/// However it is written.
TEST_F(BadInput, AKeyGivenTwiceWithEscapesIsRefused) {
  std::string text = oneTriangle().text();
  text.insert(1, "\"a\\u0062c\": 1, \"abc\": 2, ");
  expectError("twice.gltf", text, "gives the key 'abc' twice");
}

TEST_F(BadInput, ANegativeStrideIsRefused) {
  json j = json::parse(oneTriangle().text());
  j["bufferViews"][0]["byteStride"] = -1;
  expectError("stride.gltf", j.dump(2), "byteStride");
}

TEST_F(BadInput, CyclesAndTwoParents) {
  GltfBuilder cycle = oneTriangle();
  cycle.push("nodes", {{"children", {0}}});
  cycle.json["nodes"][0]["children"] = {1};
  expectError(cycle, "node 0: is reached twice");
  GltfBuilder self = oneTriangle();
  self.json["nodes"][0]["children"] = {0};
  expectError(self, "is reached twice");
  GltfBuilder twoParents = oneTriangle();
  twoParents.push("nodes", json::object());
  twoParents.json["nodes"][0]["children"] = {1};
  twoParents.addRoot({{"children", {1}}});
  expectError(twoParents, "two parents");
}

TEST_F(BadInput, DeepHierarchyLoads) {
  GltfBuilder b = oneTriangle();
  const int depth = 20000;
  for (int i = 0; i < depth; ++i) b.json["nodes"].push_back({{"children", {i + 2}}, {"translation", {0, 0, 0.001}}});
  b.json["nodes"].push_back({{"mesh", 0}});
  b.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = b.load(folder);
  EXPECT_EQ(scene.registry.size(), size_t(depth) + 2);
  EXPECT_NEAR(scene.origin.z + worldBounds(scene).hi.z, 0.001 * depth, 1e-5);
}

TEST_F(BadInput, DefectiveTrianglesAreDroppedAndCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  GltfBuilder b;
  const int positions =
      b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}, {inf, 0, 0}, {2, 0, 0}, {1e30f, 0, 0}, {0, 1e30f, 0}});
  const int normals = b.floats({nan, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  b.addMeshNode({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                 {"indices", b.indices({0, 1, 2, 0, 1, 3, 4, 1, 2, 0, 1, 5, 1, 1, 2, 0, 6, 7})}});
  const Scene scene = b.load(folder);
  const Mesh& m = scene.assets.meshes.at(0);
  EXPECT_EQ(m.triangles.size(), 1u);
  EXPECT_TRUE(hasWarning(scene, "2 triangle(s) without area"));
  EXPECT_TRUE(hasWarning(scene, "3 triangle(s) with a position that is not a finite number"));
  for (const vec3& n : m.normals) expectNear(n, {0, 0, 1}); // the broken ones are made from the triangle
  for (const vec3& p : m.positions) EXPECT_TRUE(isFinite(p));
  expectNear(m.boundsObject.hi, {1, 1, 0});
}

TEST_F(BadInput, NothingToShowLoadsWithAWarning) {
  GltfBuilder nothing;
  const Scene empty = nothing.load(folder);
  EXPECT_TRUE(hasWarning(empty, "no triangles"));
  EXPECT_TRUE(worldBounds(empty).empty());
  EXPECT_TRUE(sceneCameras(empty).empty());
  SceneExtractor extractor;
  const SceneView view = extractor.extract(empty, defaultView(empty), 0);
  EXPECT_TRUE(view.instances.empty() && view.lights.empty());
  EXPECT_FALSE(empty.assets.materials.empty());

  GltfBuilder allFlat;
  allFlat.addMeshNode({{"attributes", {{"POSITION", allFlat.positions({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}})}}}});
  const Scene flat = allFlat.load(folder);
  EXPECT_EQ(flat.registry.count<MeshInstance>(), 0u);
  EXPECT_TRUE(flat.assets.meshes.empty());
  EXPECT_TRUE(hasWarning(flat, "no triangles"));
}

TEST_F(BadInput, SceneWithoutLightOrCameraHasADefaultView) {
  const Scene scene = oneTriangle().load(folder);
  EXPECT_TRUE(sceneCameras(scene).empty());
  EXPECT_EQ(scene.registry.count<PunctualLight>(), 0u);
  const CameraView view = defaultView(scene);
  EXPECT_GT(view.position().z, 0.5f); // from the front
}

TEST_F(BadInput, ZeroElementsWithoutDataAreBounded) {
  GltfBuilder b;
  b.addMeshNode({{"attributes", {{"POSITION", b.accessor(-1, 5126, "VEC3", size_t(1) << 40)}}}});
  expectError(b, "more than this program reads");
}

/// 200 triangles of 1 mm in a row, shown by so many nodes.
GltfBuilder shownRow(int nodes) {
  GltfBuilder b;
  std::vector<vec3> corners;
  for (int i = 0; i < 200; ++i)
    for (const vec3 corner : {vec3(0), vec3(1e-3f, 0, 0), vec3(0, 1e-3f, 0)}) corners.push_back(corner + vec3(i, 0, 0));
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(corners)}}}});
  for (int i = 1; i < nodes; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, i, 0}}});
  return b;
}

/// They are drawn one by one: a file of 0.8 MB had shown 160 million.
TEST_F(BadInput, AFewBytesCannotShowMillionsOfTriangles) {
  if (kSanitized) GTEST_SKIP() << "reads 30 MB of JSON";
  GltfBuilder b = shownRow(2);
  std::vector<uint32_t> corners;
  for (uint32_t i = 0; i < 600; ++i) corners.push_back(i);
  nlohmann::json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["indices"] = b.accessor(b.view(corners), 5125, "SCALAR", corners.size());
  b.load(folder);
  // 100 primitives of these 200 triangles: 20 000 a node, 3800 nodes.
  b.json["meshes"][0]["primitives"] = nlohmann::json(size_t(100), primitive);
  for (int i = 2; i < 3800; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, i, 0}}});
  expectError(b, "brings the triangles that nodes show to");
}

/// A shape of its own for rays and OpenGL takes 600 bytes for each triangle, however few vertices it has.
TEST_F(BadInput, PosedTrianglesCountForEachNode) {
  GltfBuilder b = shownRow(1);
  nlohmann::json& primitive = b.json["meshes"][0]["primitives"][0];
  std::vector<uint32_t> corners;
  for (uint32_t i = 0; i < 12000; ++i) corners.push_back(i % 600); // 4000 triangles
  primitive["indices"] = b.accessor(b.view(corners), 5125, "SCALAR", corners.size());
  for (int i = 1; i < 300; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, i, 0}}});
  b.load(folder);
  primitive["targets"] = {{{"POSITION", primitive["attributes"]["POSITION"]}}};
  expectError(b, "needs more memory than a file of");
}

/// Also those that no triangle uses.
TEST_F(BadInput, PosedVerticesCountForEachNode) {
  GltfBuilder b;
  const int many = b.accessor(-1, 5126, "VEC3", 300000); // zeros but for
  b.json["accessors"][size_t(many)]["sparse"] = {
      {"count", 3},
      {"indices", {{"bufferView", b.view(std::vector<uint16_t>{0, 1, 2})}, {"componentType", 5123}}},
      {"values", {{"bufferView", b.view(std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}};
  b.addMeshNode({{"attributes", {{"POSITION", many}, {"NORMAL", many}}}, {"indices", b.indices({0, 1, 2})}});
  for (int i = 1; i < 12; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, i, 0}}});
  b.load(folder);
  b.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", many}}};
  expectError(b, "needs more memory than a file of");
}

/// One budget for the whole file, whatever asks for memory.
TEST_F(BadInput, AFewBytesCannotAskForGigabytes) {
  if (kSanitized) GTEST_SKIP() << "fills a gigabyte, which takes sanitizers half a minute";
  const size_t many = 1 << 22; // 50 MB of positions each
  GltfBuilder zeros;
  for (int i = 0; i < 40; ++i)
    zeros.addMeshNode({{"attributes", {{"POSITION", zeros.accessor(-1, 5126, "VEC3", many)}}}});
  expectError(zeros, "needs more memory than a file of");

  GltfBuilder keys = oneTriangle();
  for (int i = 0; i < 40; ++i) {
    const int times = keys.accessor(-1, 5126, "SCALAR", many);
    keys.animate(0, "rotation", times, keys.accessor(-1, 5126, "VEC4", many));
  }
  expectError(keys, "needs more memory than a file of");

  GltfBuilder morphs; // the same targets for many nodes: each has a shape of its own
  const int positions = morphs.accessor(-1, 5126, "VEC3", 3 << 18);
  morphs.addMeshNode({{"attributes", {{"POSITION", positions}}}, {"targets", {{{"POSITION", positions}}}}});
  for (int i = 0; i < 200; ++i) morphs.addRoot({{"mesh", 0}});
  expectError(morphs, "needs more memory than a file of");

  GltfBuilder weights = oneTriangle(); // a list of weights for each node
  weights.json["meshes"][0]["primitives"][0]["targets"] =
      json(size_t(8000), {{"POSITION", weights.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]}});
  for (int i = 0; i < 10000; ++i) weights.addRoot({{"mesh", 0}});
  expectError(weights, "needs more memory than a file of");

  GltfBuilder shining = oneTriangle(); // triangles that are lights, for each node; 40 in one place
  std::vector<vec3> triangles;
  for (int i = 0; i < 100; ++i)
    for (const vec3 corner : {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)}) triangles.push_back(corner + vec3(2 * i, 0, 0));
  std::vector<uint16_t> corners;
  for (int i = 0; i < 4000; ++i)
    for (int c = 0; c < 3; ++c) corners.push_back(uint16_t(3 * (i % 100) + c));
  shining.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = shining.positions(triangles);
  shining.json["meshes"][0]["primitives"][0]["indices"] = shining.indices(corners);
  shining.json["meshes"][0]["primitives"][0]["material"] = shining.push("materials", {{"emissiveFactor", {1, 1, 1}}});
  for (int i = 1; i <= 50; ++i) shining.addRoot({{"mesh", 0}, {"translation", {0, 2 * i, 0}}});
  shining.load(folder);
  for (int i = 0; i < 1600; ++i) shining.addRoot({{"mesh", 0}});
  expectError(shining, "needs more memory than a file of");

  writeBytes(folder / "data.bin", std::string(2 << 20, '\0'));
  json j = json::parse(oneTriangle().text());
  for (int i = 0; i < 400; ++i) j["buffers"].push_back({{"uri", "data.bin"}, {"byteLength", 2 << 20}});
  expectError("bad.gltf", j.dump(), "read so often");
}

/// A few flat colours are small files of large textures, and a file that is trusted may ask for what the machine has.
/// Of 3 bytes each: a million took 2.3 GB before it was shown.
TEST_F(BadInput, AMillionMaterialsAreCountedBeforeTheyAreParsed) {
  std::string text = R"({"asset":{"version":"2.0"},"materials":[{})";
  for (int i = 1; i < 500000; ++i) text += ",{}";
  writeBytes(folder / "many.gltf", text + "]}");
  const std::string said = inputErrorOf([&] { loadScene(folder / "many.gltf"); });
  EXPECT_NE(said.find("500000 materials"), std::string::npos) << said;
  EXPECT_NE(said.find("memory"), std::string::npos) << said;
}

TEST_F(BadInput, LargeFilesMayAskForMoreAndTrustedOnesForWhatThereIs) {
  const auto limit = [](size_t read) { return gltf::Budget{.read = read}.limit() >> 20; };
  EXPECT_LT(limit(3 << 20), 720u);
  EXPECT_GT(limit(10 << 20), 2000u);
  if (kSanitized) GTEST_SKIP() << "asks for a gigabyte";
  GltfBuilder b; // more than half of a gigabyte, of which little is kept
  for (int i = 0; i < 12; ++i) b.addMeshNode({{"attributes", {{"POSITION", b.accessor(-1, 5126, "VEC3", 3 << 20)}}}});
  expectError(b, "--allow-large");
  EXPECT_NO_THROW(b.load(folder, {.large = true}));
}

TEST_F(BadInput, KeysTwiceAndMatricesThatAreNotAffine) {
  expectError("twice.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scene": 1})", "'scene' twice");
  for (const size_t element : {3u, 7u, 11u, 15u}) {
    std::vector<float> matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    matrix[element] = 0.5f;
    GltfBuilder node = oneTriangle();
    node.json["nodes"][0]["matrix"] = matrix;
    expectError(node, "not affine");
  }
}

TEST_F(BadInput, LightBeyondPicturesIsRefused) {
  GltfBuilder b = oneTriangle();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 1e31}}};
  b.json["extensionsUsed"] = {"KHR_lights_punctual"};
  expectError(b, "beyond what pictures can hold");
  b.json.erase("extensions");
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["materials"] = {{{"emissiveFactor", {1, 1, 1}},
                          {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e31}}}}}}};
  expectError(b, "beyond what pictures can hold");
}

TEST_F(BadInput, NamesCannotForgeLines) {
  GltfBuilder b = oneTriangle();
  b.json["nodes"][0]["name"] = "a\nerror: all is well\x1b[2J\xc2\x9b";
  b.json["nodes"][0]["scale"] = {1, 2};
  b.writeGltf(folder / "bad.gltf");
  const std::string error = inputErrorOf([&] { loadScene(folder / "bad.gltf"); });
  EXPECT_NE(error.find("a\\x0aerror: all is well\\x1b[2J\\x9b"), std::string::npos) << error;
  for (const char c : error) EXPECT_GE(static_cast<unsigned char>(c), 0x20);
}

TEST_F(BadInput, APlusInAUriIsAPlus) {
  json j = json::parse(oneTriangle().text());
  const std::string uri = j["buffers"][0]["uri"];
  writeBytes(folder / "a+b c.bin", std::string(size_t(j["buffers"][0]["byteLength"]), '\0'));
  j["buffers"][0]["uri"] = "a+b%20c.bin";
  writeBytes(folder / "plus.gltf", j.dump());
  EXPECT_TRUE(hasWarning(loadScene(folder / "plus.gltf"), "without area")); // of zeros, as the file holds
}

TEST_F(BadInput, ASceneOfNothingInReachIsSaid) {
  for (const double scale : {1e20, 0.0}) {
    GltfBuilder b = oneTriangle();
    b.json["nodes"][0]["scale"] = {scale, scale, scale};
    EXPECT_TRUE(hasWarning(b.load(folder), "nothing of the scene has a size, or lies within 1e12 m")) << scale;
  }
  EXPECT_FALSE(hasWarning(oneTriangle().load(folder), "nothing of the scene"));
}

TEST_F(BadInput, TextureTransformsBeyondAnyTextureAreNone) {
  for (const char* key : {"offset", "scale"}) {
    GltfBuilder b = oneTriangle();
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    b.json["images"] = {{{"uri", "none.png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{key, {3e38, 1}}}}}}}}}}}};
    const Scene scene = b.load(folder);
    EXPECT_TRUE(hasWarning(scene, "the texture transform is beyond what finds a place in a texture")) << key;
    EXPECT_EQ(scene.assets.materials.at(0).baseColorTexture.uvTransform, mat3(1)) << key;
  }
}

TEST_F(BadInput, WhatIsFarAwayIsLeftOut) {
  GltfBuilder b = oneTriangle();
  b.addRoot({{"mesh", 0}, {"translation", {1e19, 0, 0}}});
  const Scene scene = b.load(folder);
  EXPECT_TRUE(hasWarning(scene, "1 object(s) that reach beyond 1e12 m"));
  EXPECT_LT(worldBounds(scene).diameter(), 2);
  SceneExtractor extractor;
  EXPECT_EQ(extractor.extract(scene, defaultView(scene), 0).instances.size(), 1u);
}

TEST_F(BadInput, LensesOutOfRangeAreReplaced) {
  for (const json& lens : {json{{"yfov", 3.1415926}, {"znear", 0.1}}, json{{"yfov", 1e-30}, {"znear", 0.1}},
                           json{{"yfov", 1.0}, {"znear", 1e308}}, json{{"yfov", 1.0}, {"znear", 1e-300}}}) {
    GltfBuilder b = oneTriangle();
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", lens}}};
    b.addRoot({{"camera", 0}});
    const Scene scene = b.load(folder);
    EXPECT_TRUE(hasWarning(scene, "out of range")) << lens;
    const CameraView view = sceneCameras(scene).at(0).view;
    EXPECT_TRUE(view.near > 0 && view.near < 1 && view.fovY > 0.1f && view.fovY < 3) << lens;
  }
}

TEST_F(BadInput, SparseAccessors) {
  const auto sparse = [](int count, std::vector<uint16_t> indices) {
    GltfBuilder b;
    const int indexView = b.view(indices), valueView = b.view(std::vector<vec3>(indices.size(), vec3(1)));
    const int positions = b.accessor(-1, 5126, "VEC3", 3);
    b.json["accessors"][positions]["sparse"] = {{"count", count},
                                                {"indices", {{"bufferView", indexView}, {"componentType", 5123}}},
                                                {"values", {{"bufferView", valueView}}}};
    b.addMeshNode({{"attributes", {{"POSITION", positions}}}});
    return b;
  };
  expectError(sparse(2, {0, 3}), "sparse index 3 is beyond the last of 3");
  expectError(sparse(3, {0, 1}), "run past the end");
  expectError(sparse(9, {0, 1}), "more sparse values than elements");
  expectError(sparse(-1, {0, 1}), "negative");
}

TEST_F(BadInput, Animations) {
  const auto animated = [](std::vector<float> times, std::vector<float> values, const char* interpolation) {
    GltfBuilder b = oneTriangle();
    const int input = b.floats(times);
    b.animate(0, "translation", input, b.floats(values, "VEC3"), interpolation);
    b.json["animations"][0]["name"] = "move";
    return b;
  };
  expectError(animated({0, 1}, {0, 0, 0}, "LINEAR"), "animation 0 'move', channel 0: has 1 values for 2 keys");
  expectError(animated({0, 1}, {0, 0, 0, 1, 1, 1}, "CUBICSPLINE"), "6 expected");
  expectError(animated({1, 0}, {0, 0, 0, 1, 1, 1}, "LINEAR"), "the time of key 1");
  GltfBuilder node = animated({0}, {0, 0, 0}, "LINEAR");
  node.json["animations"][0]["channels"][0]["target"]["node"] = 5;
  expectError(node, "refers to node 5");
  GltfBuilder sampler = animated({0}, {0, 0, 0}, "LINEAR");
  sampler.json["animations"][0]["channels"][0]["sampler"] = 1;
  expectError(sampler, "refers to sampler 1");
}

/// Every byte of a small file damaged in turn: whatever comes out is a scene or an InputError.
TEST_F(BadInput, SingleDamagedBytesNeverCrash) {
  GltfBuilder b = oneTriangle();
  b.json["materials"] = {{{"name", "m"}, {"emissiveFactor", {1, 1, 1}}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.writeGlb(folder / "whole.glb");
  const std::string whole = readBytes(folder / "whole.glb");
  const char replacements[] = {'\0', '9', '-', char(0xff)};
  size_t refused = 0;
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = replacements[i % 4];
    writeBytes(folder / "damaged.glb", damaged);
    try {
      loadScene(folder / "damaged.glb");
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, whole.size() / 2);
}

} // namespace lambent::test::bad_input_test
