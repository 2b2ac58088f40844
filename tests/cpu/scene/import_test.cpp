// What glTF can say about geometry, materials and nodes, each in the smallest file that says it.

#include "tests/cpu/scene/support.h"

namespace lambent::test::import_test {

const std::vector<vec3> kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

class Import : public ::testing::Test {
 protected:
  const Mesh& onlyMesh(const GltfBuilder& b) {
    scene = b.load(folder);
    EXPECT_EQ(scene.assets.meshes.size(), 1u);
    return scene.assets.meshes.at(0);
  }
  /// A picture of one colour as PNG bytes.
  TemporaryFolder folder;
  Scene scene;
};

/// Sum of the triangles' area vectors: area and facing at once.
vec3 areaVector(const Mesh& m) {
  vec3 sum(0);
  for (const uvec3& t : m.triangles)
    sum += 0.5f * glm::cross(m.positions[t.y] - m.positions[t.x], m.positions[t.z] - m.positions[t.x]);
  return sum;
}

/// Where the surface lies on the mean.
vec3 centroid(const Mesh& m) {
  vec3 sum(0);
  float areas = 0;
  for (const uvec3& t : m.triangles) {
    const vec3 a = m.positions[t.x], b = m.positions[t.y], c = m.positions[t.z];
    const float area = 0.5f * glm::length(glm::cross(b - a, c - a));
    sum += area * (a + b + c) / 3.0f;
    areas += area;
  }
  return sum / areas;
}

TEST_F(Import, TriangleWithoutNormalsOrIndicesGetsFlatNormals) {
  const Mesh& m = onlyMesh(oneTriangle());
  ASSERT_EQ(m.triangles.size(), 1u);
  ASSERT_EQ(m.normals.size(), 3u);
  for (const vec3& n : m.normals) expectNear(n, {0, 0, 1});
  expectNear(m.boundsObject.hi, {1, 1, 0});
  EXPECT_EQ(scene.assets.materials.size(), 1u); // the default one
  EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(Import, IndexedStripAndFanMakeTheSameSquare) {
  struct Case {
    int mode;
    std::vector<uint16_t> indices;
  };
  for (const Case& c : {Case{4, {0, 1, 2, 0, 2, 3}}, Case{5, {0, 1, 3, 2}}, Case{6, {0, 1, 2, 3}}}) {
    SCOPED_TRACE(c.mode);
    GltfBuilder b;
    const int positions = b.positions(kSquare);
    b.addMeshNode({{"attributes", {{"POSITION", positions}}}, {"indices", b.indices(c.indices)}, {"mode", c.mode}});
    const Mesh& m = onlyMesh(b);
    EXPECT_EQ(m.triangles.size(), 2u);
    expectNear(areaVector(m), {0, 0, 1});
    expectNear(centroid(m), {0.5f, 0.5f, 0});
    EXPECT_EQ(m.positions.size(), 6u); // flat normals: no vertex is shared
  }
}

TEST_F(Import, PointsAndLinesAreLeftOutWithAWarning) {
  GltfBuilder b = oneTriangle();
  for (int mode = 0; mode < 4; ++mode)
    b.addMeshNode({{"attributes", {{"POSITION", b.positions(kSquare)}}}, {"mode", mode}});
  scene = b.load(folder);
  EXPECT_EQ(scene.registry.count<MeshInstance>(), 1u);
  EXPECT_TRUE(hasWarning(scene, "4 primitive(s) of points or lines"));
}

TEST_F(Import, InterleavedVerticesAreReadWithTheirStride) {
  GltfBuilder b;
  std::vector<float> data; // position, normal, uv
  for (const vec3& p : kSquare) data.insert(data.end(), {p.x, p.y, p.z, 0, 0, 2, p.x + 5, p.y});
  const int view = b.view(data, 32);
  b.addMeshNode({{"attributes",
                  {{"POSITION", b.accessor(view, 5126, "VEC3", 4)},
                   {"NORMAL", b.accessor(view, 5126, "VEC3", 4, 12)},
                   {"TEXCOORD_0", b.accessor(view, 5126, "VEC2", 4, 24)}}},
                 {"indices", b.indices({0, 1, 2, 0, 2, 3})}});
  const Mesh& m = onlyMesh(b);
  ASSERT_EQ(m.positions.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    expectNear(m.positions[i], kSquare[i]);
    expectNear(m.normals[i], {0, 0, 1}); // made unit
    EXPECT_FLOAT_EQ(m.uv0[i].x, kSquare[i].x + 5);
  }
}

TEST_F(Import, SparseAccessorOverZerosMovesSomeVertices) {
  GltfBuilder b;
  const int indexView = b.view(std::vector<uint16_t>{1, 2});
  const int valueView = b.view(std::vector<vec3>{{2, 0, 0}, {0, 3, 0}});
  const int positions = b.accessor(-1, 5126, "VEC3", 3);
  b.json["accessors"][positions]["sparse"] = {{"count", 2},
                                              {"indices", {{"bufferView", indexView}, {"componentType", 5123}}},
                                              {"values", {{"bufferView", valueView}}}};
  b.addMeshNode({{"attributes", {{"POSITION", positions}}}});
  const Mesh& m = onlyMesh(b);
  expectNear(m.positions[0], {0, 0, 0});
  expectNear(m.positions[1], {2, 0, 0});
  expectNear(m.positions[2], {0, 3, 0});
}

TEST_F(Import, NormalisedAndPlainIntegersAreConverted) {
  GltfBuilder b;
  // Positions as plain signed bytes and normals as normalised ones (KHR_mesh_quantization), padded to four bytes.
  const int positions = b.view(std::vector<int8_t>{0, 0, 0, 0, 100, 0, 0, 0, 0, -50, 0, 0}, 4);
  const int normals = b.view(std::vector<int8_t>{0, 0, -127, 0, 0, 0, -128, 0, 0, 0, -127, 0}, 4);
  const int uvs = b.view(std::vector<uint16_t>{0, 0, 65535, 0, 0, 32768});
  const int colors = b.view(std::vector<uint8_t>{255, 0, 51, 0, 255, 0, 51, 0, 255, 0, 51, 0}, 4);
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  b.addMeshNode({{"attributes",
                  {{"POSITION", b.accessor(positions, 5120, "VEC3", 3)},
                   {"NORMAL", b.accessor(normals, 5120, "VEC3", 3, 0, true)},
                   {"TEXCOORD_0", b.accessor(uvs, 5123, "VEC2", 3, 0, true)},
                   {"COLOR_0", b.accessor(colors, 5121, "VEC3", 3, 0, true)}}}});
  const Mesh& m = onlyMesh(b);
  expectNear(m.positions[1], {100, 0, 0});
  expectNear(m.positions[2], {0, -50, 0});
  expectNear(m.normals[1], {0, 0, -1}); // -128 is clamped to -1
  EXPECT_FLOAT_EQ(m.uv0[1].x, 1);
  EXPECT_NEAR(m.uv0[2].y, 0.5f, 1e-4f);
  expectNear(vec3(m.colors[0]), {1, 0, 0.2f});
  EXPECT_FLOAT_EQ(m.colors[0].w, 1);
}

TEST_F(Import, VertexColoursAreHeldToWhatGltfAllows) {
  GltfBuilder b;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const int colors = b.floats({2, 0.5f, -1, 50, 0.25f, nan, 1, -3, 0, 1, 0.5f, 0.75f}, "VEC4");
  b.addMeshNode({{"attributes", {{"POSITION", b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}, {"COLOR_0", colors}}}});
  const Scene scene = b.load(folder);
  const std::vector<vec4>& held = scene.assets.meshes.at(0).colors;
  EXPECT_EQ(held.at(0), vec4(1, 0.5f, 0, 1));
  EXPECT_EQ(held.at(1), vec4(0.25f, 1, 1, 0));
  EXPECT_EQ(held.at(2), vec4(0, 1, 0.5f, 0.75f));
  EXPECT_TRUE(hasWarning(scene, "2 vertex colour(s) outside of 0..1"));
}

TEST_F(Import, NumbersThatAreNoneAreTold) {
  GltfBuilder b;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const int triangle = b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const int uvs = b.floats({0.5f, 0.25f, nan, 1, 1, kInfinity}, "VEC2"), offsets = b.positions({{0, 0, 1}, {}, {}});
  const int broken = b.floats({0, nan, 0, 0, 0, 2, 0, 0, 0}, "VEC3");
  b.addMeshNode({{"attributes", {{"POSITION", triangle}, {"NORMAL", offsets}, {"TEXCOORD_0", uvs}}},
                 {"targets", {{{"POSITION", broken}}}}});
  const Scene scene = b.load(folder);
  const Mesh& mesh = scene.assets.meshes.at(0);
  EXPECT_EQ(mesh.uv0, (std::vector<vec2>{{0.5f, 0.25f}, {0, 0}, {0, 0}}));
  EXPECT_TRUE(hasWarning(scene, "2 texture coordinate(s) that are not finite numbers, taken for 0"));
  EXPECT_TRUE(hasWarning(scene, "1 offset(s) of morph targets that are not finite numbers, taken for 0"));
}

TEST_F(Import, AlphaModesOfNoKindAreTold) {
  for (const char* mode : {"OPAQUE", "MASK", "BLEND", "BLURB"}) {
    GltfBuilder b = oneTriangle();
    b.json["materials"] = {{{"alphaMode", mode}}};
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    EXPECT_EQ(hasWarning(b.load(folder), "alphaMode is none of glTF's"), std::string(mode) == "BLURB") << mode;
  }
}

/// A file that a stranger's file names may be a person's own.
TEST_F(Import, MessagesDoNotQuoteWhatAFileHolds) {
  writeBytes(folder / "other.gltf", R"({"a":"hunter2 password
)");
  const std::string message = inputErrorOf([&] { loadScene(folder / "other.gltf"); });
  EXPECT_NE(message.find("line 2"), std::string::npos) << message;
  EXPECT_EQ(message.find("hunter2"), std::string::npos) << message;
}

TEST_F(Import, PrimitivesShareVerticesAndFillUpMissingAttributes) {
  GltfBuilder b;
  const int positions = b.positions(kSquare), normals = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int uvs = b.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
  const nlohmann::json plain = {{"POSITION", positions}, {"NORMAL", normals}};
  nlohmann::json withUv = plain;
  withUv["TEXCOORD_0"] = uvs;
  b.json["materials"] = {{{"name", "a"}}, {{"name", "b"}}};
  b.addRoot({{"mesh", 0}});
  b.json["meshes"] = {{{"primitives",
                        {{{"attributes", plain}, {"indices", b.indices({0, 1, 2})}, {"material", 1}},
                         {{"attributes", plain}, {"indices", b.indices({0, 2, 3})}, {"material", 0}},
                         {{"attributes", withUv}, {"indices", b.indices({0, 2, 3})}, {"material", 1}}}}}};
  const Mesh& m = onlyMesh(b);
  EXPECT_EQ(m.positions.size(), 8u); // four shared by the first two primitives, four of the third
  ASSERT_EQ(m.uv0.size(), 8u);
  EXPECT_EQ(m.uv0[2], vec2(0));
  EXPECT_EQ(m.uv0[6], vec2(1));
  ASSERT_EQ(m.primitives.size(), 3u);
  EXPECT_EQ(m.primitives[0].material, m.primitives[2].material);
  EXPECT_EQ(scene.assets.materials[m.primitives[1].material].name, "a");
  EXPECT_EQ(m.primitives[2].firstTriangle, 2u);
}

TEST_F(Import, NegativeScaleKeepsTheObjectAndMirrorsTheWorld) {
  GltfBuilder b = oneTriangle();
  b.json["nodes"][0]["scale"] = {-2, 1, 1};
  const Mesh& m = onlyMesh(b);
  expectNear(areaVector(m), {0, 0, 0.5f}); // object space is as in the file
  SceneExtractor extractor;
  const SceneView view = extractor.extract(scene, {}, 0);
  EXPECT_LT(glm::determinant(mat3(view.instances[0].worldFromObject)), 0);
  expectNear(view.boundsWorld.lo, {-2, 0, 0});
}

TEST_F(Import, MaterialsCarryColourEmissionAlphaAndTransform) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const int picture = b.view(png({255, 0, 188, 255}));
  b.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}, {"name", "pink"}}};
  b.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9986}}};
  b.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  b.json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 1, 0.75}},
         {"baseColorTexture",
          {{"index", 0},
           {"texCoord", 0},
           {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"scale", {2, 3}}, {"texCoord", 1}}}}}}}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.3},
       {"doubleSided", true}}};
  scene = b.load(folder);
  ASSERT_EQ(scene.assets.materials.size(), 1u);
  const Material& m = scene.assets.materials[0];
  EXPECT_EQ(vec2(m.dielectricF0, m.dielectricLobe), vec2(0, 1)) << "as glTF has it where nothing is said";
  expectNear(m.baseColor, {0.5f, 0.25f, 1});
  EXPECT_FLOAT_EQ(m.alpha, 0.75f);
  expectNear(m.emission, {8, 4, 0});
  EXPECT_EQ(m.alphaMode, AlphaMode::Mask);
  EXPECT_FLOAT_EQ(m.alphaCutoff, 0.3f);
  EXPECT_TRUE(m.doubleSided);
  EXPECT_FALSE(m.backHidden);
  b.json["materials"][0].erase("doubleSided");
  EXPECT_TRUE(b.load(folder).assets.materials[0].backHidden);
  for (nlohmann::json& primitive : b.json["meshes"][0]["primitives"]) primitive.erase("material");
  EXPECT_TRUE(b.load(folder).assets.materials[0].backHidden) << "glTF's default is not double-sided";
  const TextureRef& t = m.baseColorTexture;
  EXPECT_EQ(t.uvSet, 1u); // the extension's texCoord wins
  EXPECT_EQ(t.wrapU, Wrap::ClampToEdge);
  EXPECT_EQ(t.wrapV, Wrap::MirroredRepeat);
  EXPECT_TRUE(t.nearest);
  EXPECT_EQ(t.minify, Minify::NearestMipmapLinear);
  expectNear(t.uvTransform * vec3(1, 1, 1), {2.5f, 3, 1});
  const TextureImage& image = scene.assets.images.at(t.image);
  EXPECT_EQ(image.name, "pink");
  expectNear(vec3(image.averageLinear), {1, 0, 0.5029f}, 1e-3f); // 188 is half of linear light
}

TEST_F(Import, RoughnessAndMetalnessFromFactorsAndALinearTexture) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const int picture = b.view(png({255, 188, 51, 255}));
  b.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}}};
  b.json["textures"] = {{{"source", 0}}};
  const nlohmann::json texture = {{"index", 0}};
  b.json["materials"] = {{{"pbrMetallicRoughness",
                           {{"baseColorTexture", texture},
                            {"metallicRoughnessTexture", texture},
                            {"roughnessFactor", 0.5},
                            {"metallicFactor", 0.25}}}},
                         {{"pbrMetallicRoughness", {{"roughnessFactor", 7}, {"metallicFactor", -1}}}},
                         {{"name", "plain"}}};
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(kSquare)}}}, {"material", 1}});
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(kSquare)}}}, {"material", 2}});
  scene = b.load(folder);
  const std::vector<Material>& m = scene.assets.materials;
  ASSERT_EQ(m.size(), 3u);
  EXPECT_FLOAT_EQ(m[0].roughness, 0.5f);
  EXPECT_FLOAT_EQ(m[0].metalness, 0.25f);
  // The same picture twice: as a colour it is sRGB, as roughness and metalness it is linear.
  ASSERT_NE(m[0].roughnessMetalnessTexture.image, m[0].baseColorTexture.image);
  const TextureImage &color = scene.assets.images.at(m[0].baseColorTexture.image),
                     &roughnessMetalness = scene.assets.images.at(m[0].roughnessMetalnessTexture.image);
  EXPECT_NEAR(color.averageLinear.y, 0.5029f, 1e-3f);
  EXPECT_NEAR(roughnessMetalness.averageLinear.y, 188 / 255.0f, 1e-6f);
  EXPECT_NEAR(roughnessMetalness.averageLinear.z, 0.2f, 1e-6f);
  EXPECT_EQ(m[1].roughness, 1);
  EXPECT_EQ(m[1].metalness, 0);
  EXPECT_TRUE(hasWarning(scene, "the roughness is out of range"));
  EXPECT_TRUE(hasWarning(scene, "the metalness is out of range"));
  EXPECT_EQ(m[2].roughness, 1); // glTF's defaults
  EXPECT_EQ(m[2].metalness, 1);
}

TEST_F(Import, TakesBlendedMaterials) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["materials"] = {{{"alphaMode", "BLEND"}, {"extensions", {{"KHR_materials_transmission", {{"x", 1}}}}}}};
  scene = b.load(folder);
  EXPECT_EQ(scene.assets.materials[0].alphaMode, AlphaMode::Blend);
  EXPECT_TRUE(hasWarning(scene, "KHR_materials_transmission"));
}

TEST_F(Import, DanglingImageIsWhiteAndUnreadableImageThatNothingUsesIsIgnored) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["images"] = {{{"uri", "not-there.png"}}};
  b.json["textures"] = {{{"source", 7}}};
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  scene = b.load(folder);
  EXPECT_EQ(scene.assets.materials[0].baseColorTexture.image, kNone);
  EXPECT_TRUE(hasWarning(scene, "white instead"));
}

/// Each way of sampling is a program of its own to drivers that draw on the CPU.
TEST_F(Import, MaterialsThatSampleInManyWaysAreRefusedUnlessTheFileIsTrusted) {
  const auto of = [&](int count) {
    GltfBuilder b = oneTriangle();
    b.json["images"] = {{{"bufferView", b.view(png({255, 0, 188, 255}))}, {"mimeType", "image/png"}}};
    for (int i = 0; i < 3 * 3 * 2 * 6; ++i) {
      constexpr int kWraps[] = {10497, 33071, 33648}, kMinify[] = {9728, 9729, 9984, 9985, 9986, 9987};
      b.push("samplers", {{"wrapS", kWraps[i % 3]},
                          {"wrapT", kWraps[i / 3 % 3]},
                          {"magFilter", 9728 + i / 9 % 2},
                          {"minFilter", kMinify[i / 18]}});
      b.push("textures", {{"source", 0}, {"sampler", i}});
    }
    for (int i = 0; i < count; ++i) {
      nlohmann::json mesh = b.json["meshes"][0];
      mesh["primitives"][0]["material"] =
          b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
      b.addRoot({{"mesh", b.push("meshes", mesh)}});
    }
    return b;
  };
  EXPECT_NO_THROW(of(63).load(folder)) << "and one without a texture";
  EXPECT_THROW(of(66).load(folder), InputError);
  EXPECT_NO_THROW(of(66).load(folder, {.large = true}));
}

TEST_F(Import, LightsHaveGltfUnitsAndCones) {
  GltfBuilder b = oneTriangle();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"},
       {"color", {1, 0.5, 0}},
       {"intensity", 10},
       {"range", 4},
       {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}},
      {{"type", "directional"}, {"intensity", 3}}};
  b.addRoot({{"name", "lamp"},
             {"translation", {1, 2, 3}},
             {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}, // -Z turned to -Y
             {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.addRoot({{"name", "sun"}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  scene = b.load(folder);
  SceneExtractor extractor;
  const SceneView view = extractor.extract(scene, {}, 0);
  ASSERT_EQ(view.lights.size(), 2u);
  EXPECT_EQ(view.lights[0].type, LightType::Spot);
  expectNear(view.lights[0].position, {1, 2, 3});
  expectNear(view.lights[0].direction, {0, -1, 0});
  expectNear(view.lights[0].intensity, {10, 5, 0});
  EXPECT_FLOAT_EQ(view.lights[0].range, 4);
  EXPECT_FLOAT_EQ(view.lights[0].innerConeCos, std::cos(0.2f));
  EXPECT_FLOAT_EQ(view.lights[0].outerConeCos, std::cos(0.6f));
  EXPECT_EQ(view.lights[1].type, LightType::Directional);
  expectNear(view.lights[1].direction, {0, 0, -1});
  EXPECT_EQ(view.lights[1].range, kInfinity);
}

TEST_F(Import, SceneIsChosenByNameIndexOrDefault) {
  GltfBuilder b = oneTriangle();
  b.push("nodes", {{"name", "second root"}});
  b.json["scenes"][0]["name"] = "first";
  b.push("scenes", {{"name", "second"}, {"nodes", {1}}});
  b.json["scene"] = 1;
  const auto file = folder / "two.gltf";
  b.writeGltf(file);
  EXPECT_TRUE(findByName(loadScene(file), "second root"));
  EXPECT_EQ(loadScene(file, "first").registry.count<MeshInstance>(), 1u);
  EXPECT_EQ(loadScene(file, "0").registry.count<MeshInstance>(), 1u);
  const std::string error = inputErrorOf([&] { loadScene(file, "third"); });
  EXPECT_NE(error.find("it has: first, second"), std::string::npos) << error;
}

TEST_F(Import, ASceneTellsItsSkyInExtras) {
  const fs::path file = folder / "sky.gltf", picture = folder / "studio.hdr";
  const std::string texels("\x80\x40\x20\x81\x80\x80\x80\x80", 8);
  writeBytes(picture, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + texels);
  GltfBuilder b = oneTriangle();
  const auto told = [&](const nlohmann::json& sky) {
    b.json["scenes"][0]["extras"] = {{"lambent_sky", sky}};
    b.writeGltf(file);
    scene = loadScene(file);
  };
  told({0.5, 1, 2});
  expectNear(scene.sky.radiance({0, 1, 0}), {0.5f, 1, 2});
  EXPECT_TRUE(scene.sky.constant());
  told({{"image", "studio.hdr"}, {"scale", 3}, {"turn", 90}});
  ASSERT_NE(scene.sky.picture().image, nullptr);
  EXPECT_EQ(scene.sky.picture().scale, 3);
  EXPECT_FLOAT_EQ(scene.sky.picture().turn, kPi / 2);
  EXPECT_NEAR(scene.sky.picture().image->texels[0].x, 1, 0.01f);
  EXPECT_EQ(scene.files.size(), 2u) << "no result may be written over it";
  EXPECT_EQ(scene.warnings.size(), 0u);

  // A picture that cannot be read is said. Nor may it lie elsewhere.
  fs::create_directory(folder / "below");
  fs::rename(picture, folder / "below" / "studio.hdr");
  told({{"image", "below/studio.hdr"}});
  EXPECT_FALSE(scene.sky.black());
  told({{"image", "studio.hdr"}});
  EXPECT_TRUE(scene.sky.black());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("studio.hdr: no such file in the scene's folder"), std::string::npos);
  writeBytes(picture, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + texels.substr(1));
  told({{"image", "studio.hdr"}});
  EXPECT_TRUE(scene.sky.black());
  EXPECT_EQ(scene.warnings.size(), 1u) << "cut off";
  GltfBuilder inner = oneTriangle();
  inner.json["scenes"][0]["extras"] = {{"lambent_sky", {{"image", "%2e%2e/below/studio.hdr"}}}};
  fs::create_directory(folder / "own");
  inner.writeGltf(folder / "own" / "sky.gltf");
  EXPECT_TRUE(loadScene(folder / "own" / "sky.gltf").sky.black());
  EXPECT_FALSE(loadScene(folder / "own" / "sky.gltf", {}, {}, {.outside = true}).sky.black());

  const std::vector<nlohmann::json> wrong = {1,
                                             "studio.hdr",
                                             {1, 2},
                                             {1, -2, 3},
                                             {1, "a", 3},
                                             {1e31, 0, 0},
                                             {{"scale", 1}},
                                             {{"image", 3}},
                                             {{"image", "below/studio.hdr"}, {"scal", 1}}};
  for (const nlohmann::json& sky : wrong) EXPECT_THROW(told(sky), InputError) << sky;
  for (const double scale : {0.0, -1.0, 1e9})
    EXPECT_THROW(told({{"image", "below/studio.hdr"}, {"scale", scale}}), InputError);
  EXPECT_THROW(told({{"image", "below/studio.hdr"}, {"turn", 361}}), InputError);
}

TEST_F(Import, SkinnedMeshIsPlacedByItsJointsAlone) {
  GltfBuilder b;
  const int positions = b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const int joints = b.accessor(b.view(std::vector<uint8_t>(12, 0)), 5121, "VEC4", 3);
  const int weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  const int node =
      b.addMeshNode({{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}});
  const int joint = b.addRoot({{"translation", {0, 0, 5}}});
  b.json["skins"] = {{{"joints", {joint}}}};
  b.json["nodes"][node]["skin"] = 0;
  b.json["nodes"][node]["translation"] = {9, 9, 9}; // glTF: does not move a skinned mesh
  scene = b.load(folder);
  expectNear(worldBounds(scene).lo, {0, 0, 5});
}

TEST_F(Import, BinaryFileIsTheSameScene) {
  GltfBuilder b = oneTriangle();
  b.json["nodes"][0]["translation"] = {1, 2, 3};
  const std::vector<uint8_t> picture = png({10, 20, 30, 255});
  writeBytes(folder / "a.png", {picture.begin(), picture.end()});
  b.json["images"] = {{{"uri", "a.png"}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene text = b.load(folder);
  b.writeGlb(folder / "triangle.glb");
  scene = loadScene(folder / "triangle.glb");
  EXPECT_EQ(scene.assets.meshes.at(0).triangles, text.assets.meshes.at(0).triangles);
  EXPECT_EQ(scene.assets.meshes.at(0).positions, text.assets.meshes.at(0).positions);
  ASSERT_EQ(scene.assets.images.size(), 1u);
  EXPECT_EQ(scene.assets.images[0].texels, text.assets.images.at(0).texels);
  EXPECT_EQ(scene.assets.images[0].texels.at(0), u8vec4(10, 20, 30, 255));
  expectNear(worldBounds(scene).lo, worldBounds(text).lo);
  expectNear(worldBounds(scene).lo, {1, 2, 3});
}

TEST_F(Import, MatrixNodesAreTakenApartUnlessSheared) {
  GltfBuilder b = oneTriangle();
  b.json["nodes"][0]["matrix"] = {0, 0, -2, 0, 0, 3, 0, 0, 1, 0, 0, 0, 5, 6, 7, 1};
  scene = b.load(folder);
  const Transform& t = scene.registry.get<Transform>(Entity(0, 0));
  EXPECT_FALSE(t.matrix);
  expectNear(t.translation, {5, 6, 7});
  expectNear(glm::abs(t.scale), {2, 3, 1});
  expectNear(vec3(t.local() * vec4(1, 0, 0, 1)), {5, 6, 5});
  b.json["nodes"][0]["matrix"] = {-2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; // a mirror
  scene = b.load(folder);
  EXPECT_FALSE(scene.registry.get<Transform>(Entity(0, 0)).matrix);
  expectNear(vec3(scene.registry.get<Transform>(Entity(0, 0)).local() * vec4(1)), {-2, 3, 1});
  b.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  scene = b.load(folder);
  EXPECT_TRUE(scene.registry.get<Transform>(Entity(0, 0)).matrix);
}

/// All roots are shown then, and children with them.
TEST_F(Import, AFileWithoutScenesShowsEachNodeOnce) {
  GltfBuilder b = oneTriangle();
  b.json.erase("scenes");
  b.json.erase("scene");
  b.json["nodes"][0]["children"] = {1};
  b.push("nodes", {{"name", "child"}, {"mesh", 0}, {"translation", {0, 0, 5}}});
  scene = b.load(folder);
  SceneExtractor extractor;
  EXPECT_EQ(extractor.extract(scene, {}, 0).instances.size(), 2u);
  EXPECT_TRUE(findByName(scene, "child"));
}

TEST_F(Import, AnimationsOfNodesOfAnotherSceneAreLeftOut) {
  GltfBuilder b = oneTriangle();
  const int other = b.push("nodes", {{"name", "elsewhere"}});
  b.push("scenes", {{"nodes", {other}}});
  b.animate(other, "translation", b.floats({0, 1}), b.floats({0, 0, 0, 1, 1, 1}, "VEC3"));
  b.json["scene"] = 0;
  scene = b.load(folder);
  EXPECT_NO_THROW(animate(scene, 0.5));
  EXPECT_FALSE(findByName(scene, "elsewhere"));
}

TEST_F(Import, NegativeLightIsLeftOutAndSaid) {
  GltfBuilder b = oneTriangle();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, -0.5, 0}}, {"intensity", 10}}};
  b.addRoot({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  scene = b.load(folder);
  SceneExtractor extractor;
  expectNear(extractor.extract(scene, {}, 0).lights[0].intensity, {10, 0, 0});
  EXPECT_TRUE(hasWarning(scene, "negative light"));
}

/// KHR_texture_transform: rotation turns counter-clockwise from +u away from +v, which runs down.
TEST_F(Import, TextureTransformsTurn) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["images"] = {{{"bufferView", b.view(png({255, 0, 188, 255}))}, {"mimeType", "image/png"}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", kPi / 2}}}}}}}}}}};
  scene = b.load(folder);
  const mat3& turn = scene.assets.materials[0].baseColorTexture.uvTransform;
  expectNear(turn * vec3(1, 0, 1), {0, -1, 1});
  expectNear(turn * vec3(0, 1, 1), {1, 0, 1});
}

TEST_F(Import, IndexOfRefractionAndSpecularGiveF0AndWeight) {
  const auto finishOf = [&](const nlohmann::json& extensions, const std::string& warning = {}) {
    GltfBuilder b = oneTriangle();
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    b.json["materials"] = {{{"extensions", extensions}}};
    b.json["extensionsRequired"] = {"KHR_materials_ior", "KHR_materials_specular"};
    const Scene scene = b.load(folder);
    EXPECT_EQ(hasWarning(scene, warning), !warning.empty()) << warning;
    const Material& m = scene.assets.materials.at(0);
    return vec2(m.dielectricF0, m.dielectricLobe);
  };
  const auto ior = [](double n) { return nlohmann::json{{"KHR_materials_ior", {{"ior", n}}}}; };
  const auto specular = [](const nlohmann::json& values) { return nlohmann::json{{"KHR_materials_specular", values}}; };
  const auto near = [](const vec2& a, const vec2& b) { return glm::length(a - b) < 1e-6f; };
  EXPECT_PRED2(near, finishOf(ior(2)), vec2(1 / 9.0f, 1));
  EXPECT_PRED2(near, finishOf(ior(0)), vec2(1, 1)); // a mirror, as the extension says
  EXPECT_PRED2(near, finishOf(ior(1)), vec2(0, 0));
  EXPECT_PRED2(near, finishOf(ior(0.5), "the index of refraction is below 1"), vec2(0.04f, 1));
  EXPECT_PRED2(near, finishOf(specular({{"specularFactor", 0.25}})), vec2(0.04f, 0.25f));
  EXPECT_PRED2(near, finishOf(specular({{"specularFactor", 7}}), "specularFactor is out of range"), vec2(0.04f, 1));
  EXPECT_PRED2(near, finishOf(specular({{"specularColorFactor", {2, 2, 2}}})), vec2(0.08f, 1));
  EXPECT_PRED2(near, finishOf(specular({{"specularColorFactor", {100, 100, 100}}})), vec2(1, 1));
  EXPECT_PRED2(near, finishOf(specular({{"specularColorFactor", {1, 0, 0}}}), "counts by its luminance"),
               vec2(0.04f * 0.2126f, 1));
  EXPECT_PRED2(near, finishOf(specular({{"specularTexture", {{"index", 0}}}}), "specularTexture is not used"),
               vec2(0.04f, 1));
}

TEST_F(Import, OcclusionTexturesAreTold) {
  for (const bool occluded : {false, true}) {
    GltfBuilder b = oneTriangle();
    b.json["materials"] = {{{"name", "m"}}};
    if (occluded) b.json["materials"][0]["occlusionTexture"] = {{"index", 0}};
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    EXPECT_EQ(hasWarning(b.load(folder), "occlusionTexture is not used"), occluded);
  }
}

TEST_F(Import, ACoatTakesThePlaceOfTheGlossOfWhatIsNoMetal) {
  const auto materialOf = [&](double metalness, const nlohmann::json& coat) {
    GltfBuilder b = oneTriangle();
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    b.json["materials"] = {
        {{"pbrMetallicRoughness",
          {{"metallicFactor", metalness}, {"roughnessFactor", 0.8}, {"metallicRoughnessTexture", {{"index", 0}}}}},
         {"extensions", {{"KHR_materials_clearcoat", coat}, {"KHR_materials_ior", {{"ior", 2}}}}}}};
    b.json["images"] = {
        {{"uri", "data:image/png;base64,"
                 "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5Erk"
                 "Jggg=="}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["extensionsRequired"] = {"KHR_materials_clearcoat"};
    scene = b.load(folder);
    return scene.assets.materials.at(0);
  };
  const Material coated = materialOf(0, {{"clearcoatFactor", 0.75}, {"clearcoatRoughnessFactor", 0.1}});
  EXPECT_EQ(coated.dielectricF0, 0) << "of an index of refraction of 1.5, whatever the base has";
  EXPECT_EQ(coated.roughnessMetalnessTexture.image, kNone) << "the base's";
  EXPECT_FLOAT_EQ(coated.roughness, 0.1f);
  EXPECT_FLOAT_EQ(coated.dielectricLobe, 0.75f);
  EXPECT_TRUE(hasWarning(scene, "1 material(s) whose coat takes the place of their own gloss"));
  for (const auto& [metalness, factor] : {std::pair(1.0, 1.0), {0.0, 0.25}}) {
    EXPECT_FLOAT_EQ(materialOf(metalness, {{"clearcoatFactor", factor}}).roughness, 0.8f);
    EXPECT_TRUE(hasWarning(scene, "KHR_materials_clearcoat shown without it"));
  }
  EXPECT_FLOAT_EQ(materialOf(0, nlohmann::json::object()).roughness, 0.8f);
  EXPECT_TRUE(scene.warnings.empty()) << "no coat";
}

TEST_F(Import, SamplersAndTransformsThatAreNoneAreTold) {
  const auto load = [&](const nlohmann::json& sampler, const nlohmann::json& transform) {
    GltfBuilder b = oneTriangle();
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    b.json["images"] = {
        {{"uri", "data:image/png;base64,"
                 "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5Erk"
                 "Jggg=="}}};
    b.json["samplers"] = {sampler};
    b.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
    b.json["materials"] = {
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}}};
    scene = b.load(folder);
  };
  load({{"wrapS", 33071}, {"minFilter", 9987}, {"magFilter", 9728}}, {{"scale", {2, 3}}, {"rotation", 1}});
  EXPECT_TRUE(scene.warnings.empty());
  load({{"wrapS", 3}, {"minFilter", 7}, {"magFilter", 9984}}, {{"scale", "x"}, {"offset", {1}}, {"rotation", {1}}});
  for (const char* said : {"wrap mode 3 is none", "minFilter 7 is none", "magFilter 9984 is none",
                           "'s scale is no pair", "'s offset is no pair", "'s rotation is no number"})
    EXPECT_TRUE(hasWarning(scene, said)) << said;
}

TEST_F(Import, UnlitIsALambertSurfaceOfItsColour) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}}},
                          {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}}};
  b.json["extensionsRequired"] = {"KHR_materials_unlit"};
  scene = b.load(folder);
  const Material& unlit = scene.assets.materials.at(0);
  expectNear(unlit.baseColor, {0.5f, 0.25f, 1});
  EXPECT_FALSE(unlit.glossy()) << "glTF's default is a metal";
  EXPECT_EQ(unlit.dielectricLobe, 0);
  EXPECT_TRUE(std::ranges::any_of(scene.warnings, [](const std::string& w) { return w.ends_with("shown lit"); }));
}

/// The same triangle baked into a place far off, and moved back by its node: what rays and shaders get is small
/// numbers.
TEST_F(Import, MeshesFarFromTheirOriginCountFromTheirMiddle) {
  const std::vector<vec3> corners = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  for (const float far : {0.0f, 1000.0f, 65536.0f})
    for (const bool back : {false, true}) {
      GltfBuilder b;
      std::vector<vec3> moved;
      for (const vec3& p : corners) moved.push_back(p + vec3(far, -far, far));
      b.addMeshNode({{"attributes", {{"POSITION", b.positions(moved)}}}});
      if (back) b.json["nodes"][0]["translation"] = {-far, far, -far};
      scene = b.load(folder);
      const Mesh& mesh = scene.assets.meshes.at(0);
      for (const vec3& p : mesh.positions) EXPECT_LE(maxComponent(glm::abs(p)), 2) << far << back;
      SceneExtractor extractor;
      const SceneView view = extractor.extract(scene, {}, 0);
      const mat4& m = view.instances[0].worldFromObject;
      const dvec3 home = back ? dvec3(0) : dvec3(far, -far, far);
      for (size_t i = 0; i < 3; ++i)
        expectNear(vec3(dvec3(vec3(m * vec4(mesh.positions[i], 1))) + scene.origin - home), corners[i]);
      expectNear(view.boundsWorld.size(), {2, 2, 0});
    }
}

} // namespace lambent::test::import_test
