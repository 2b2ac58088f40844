// Tangent spaces: made, read, and the normals that maps give in them.
#include "support.h"

#include "engine/scene/deform.h"
#include "engine/scene/tangents.h"
#include "engine/view/surface_point.h"

namespace lambent::test::tangents_test {

namespace {

/// A square on z = 0, corners counter-clockwise from (0, 0), in two triangles.
struct Square {
  std::vector<vec3> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, normals{4, vec3(0, 0, 1)};
  std::vector<vec2> uvs{{0, 1}, {1, 1}, {1, 0}, {0, 0}}; // as seen: u to the right, v downwards
  std::vector<uvec3> triangles{{0, 1, 2}, {0, 2, 3}};

  std::vector<CornerTangent> made() const { return cornerTangents(positions, normals, uvs, triangles); }
};

void expectTangent(const vec4& is, const vec3& direction, float side) {
  EXPECT_LT(glm::length(vec3(is) - direction), 1e-6f) << is.x << ' ' << is.y << ' ' << is.z;
  EXPECT_EQ(is.w, side);
}

std::vector<float> flat(const std::vector<vec2>& of) { return {&of[0].x, &of[0].x + 2 * of.size()}; }
std::vector<float> flat(const std::vector<vec3>& of) { return {&of[0].x, &of[0].x + 3 * of.size()}; }
std::vector<float> flat(const std::vector<vec4>& of) { return {&of[0].x, &of[0].x + 4 * of.size()}; }

} // namespace

TEST(Tangents, LieAlongTheTextureAndBitangentsAgainstItsDownwards) {
  Square square;
  for (const CornerTangent& c : square.made()) expectTangent(c.tangent, {1, 0, 0}, 1);
  for (vec2& uv : square.uvs) uv.x = -uv.x;
  for (const CornerTangent& c : square.made()) expectTangent(c.tangent, {-1, 0, 0}, -1);
  for (vec2& uv : square.uvs) uv = {uv.y, uv.x}; // now u runs down and v to the left
  for (const CornerTangent& c : square.made()) expectTangent(c.tangent, {0, -1, 0}, 1);
}

/// The mean is by the angles at the vertex, whatever the sizes of triangles and of their texture.
TEST(Tangents, AreMeansByAngle) {
  Square square;
  // Around vertex 0: the first triangle spans 45 degrees with u along x, the second 90 with u along its own slant.
  square.positions[2] = {5, 5, 0}, square.positions[3] = {-1, 1, 0};
  square.uvs = {{0, 1}, {1, 1}, {1, -4}, {-3, -2}};
  const std::vector<CornerTangent> made = square.made();
  EXPECT_EQ(made[0].group, made[3].group);
  EXPECT_EQ(made[0].tangent, made[3].tangent);
  // First: u = x, so along x. Second: (5,5) -> (1,-5), (-1,1) -> (-3,-3): the texture's u grows along s.
  const vec2 u1(1, -5), u2(-3, -3), p1(5, 5), p2(-1, 1);
  const float area = u1.x * u2.y - u1.y * u2.x;
  ASSERT_LT(area, 0) << "of one kind with the first";
  const vec2 s = glm::normalize(-(u2.y * p1 - u1.y * p2));
  const vec2 mean = glm::normalize(vec2(1, 0) + 2.0f * s);
  expectTangent(made[0].tangent, vec3(mean, 0), 1);
}

TEST(Tangents, OfMirroredNeighboursAreApartAndOfDistantOnesToo) {
  Square square;
  square.positions.push_back({2, 1, 0}); // beyond the right edge, mirrored there
  square.positions.push_back({2, 0, 0});
  square.normals.assign(6, vec3(0, 0, 1));
  square.uvs.push_back({0, 0});
  square.uvs.push_back({0, 1});
  square.triangles.push_back({1, 5, 2});
  square.triangles.push_back({5, 4, 2});
  const std::vector<CornerTangent> made = square.made();
  expectTangent(made[1].tangent, {1, 0, 0}, 1);
  expectTangent(made[6].tangent, {-1, 0, 0}, -1);
  EXPECT_NE(made[1].group, made[6].group) << "both at vertex 1";
  // Triangles that share a vertex and no edge have their own, though alike.
  Square two;
  two.positions.insert(two.positions.end(), {{2, 1, 0}, {2, 2, 0}});
  two.normals.assign(6, vec3(0, 0, 1));
  two.uvs.insert(two.uvs.end(), {{2, 0}, {2, -1}});
  two.triangles = {{0, 1, 2}, {2, 4, 5}};
  EXPECT_NE(two.made()[2].group, two.made()[3].group);
}

/// Vertices that a file keeps apart for something else are one for tangents.
TEST(Tangents, AreSharedByVerticesThatAreAlike) {
  Square whole, apart;
  whole.positions[3] = apart.positions[3] = {0.3f, 1, 0};
  whole.uvs[3] = apart.uvs[3] = {0.1f, -0.5f};
  for (const uint32_t i : {0u, 2u}) {
    apart.positions.push_back(apart.positions[i]);
    apart.normals.push_back(apart.normals[i]);
    apart.uvs.push_back(apart.uvs[i]);
  }
  apart.triangles[1] = {4, 5, 3};
  const auto a = whole.made(), b = apart.made();
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].tangent, b[i].tangent) << i;
  EXPECT_NE(a[1].tangent, a[0].tangent) << "the two triangles differ";
}

TEST(Tangents, AreFiniteWhereTheTextureHasNoArea) {
  Square square;
  square.uvs.assign(4, vec2(0.5f));
  for (const CornerTangent& c : square.made()) {
    EXPECT_NEAR(glm::length(vec3(c.tangent)), 1, 1e-6f);
    EXPECT_NEAR(c.tangent.z, 0, 1e-6f);
  }
  // A triangle whose texture is a line follows another where they touch, whether along an edge or at a vertex alone.
  Square half;
  half.uvs = {{1, 0}, {1, 1}, {0, 1}, {0.5f, 0.5f}};
  half.positions.insert(half.positions.end(), {{-1, 0, 0}, {-1, -1, 0}});
  half.normals.assign(6, vec3(0, 0, 1));
  half.uvs.insert(half.uvs.end(), {{2, 0}, {3, 0}});
  half.triangles.push_back({0, 4, 5});
  const std::vector<CornerTangent> made = half.made();
  for (const size_t corner : {1u, 2u, 3u, 4u, 6u}) EXPECT_EQ(made[corner].tangent, made[0].tangent) << corner;
  EXPECT_GT(std::abs(made[0].tangent.y), 0.5f) << "not what any surface has for want of a direction";
}

class TangentsOfFiles : public ::testing::Test {
 protected:
  /// The square with a normal map of one texel; its texture is mirrored beyond the middle vertices 1 and 2.
  GltfBuilder mirrored() {
    GltfBuilder b;
    const std::vector<vec3> p{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 1, 0}, {2, 0, 0}};
    const std::vector<vec2> uv{{0, 1}, {1, 1}, {1, 0}, {0, 0}, {0, 0}, {0, 1}};
    const int picture = b.view(png({255, 128, 128, 255}));
    b.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"normalTexture", {{"index", 0}, {"scale", 0.5}}}}};
    b.addMeshNode({{"attributes",
                    {{"POSITION", b.positions(p)},
                     {"NORMAL", b.floats(flat(std::vector<vec3>(6, {0, 0, 1})), "VEC3")},
                     {"TEXCOORD_0", b.floats(flat(uv), "VEC2")}}},
                   {"indices", b.indices({0, 1, 2, 0, 2, 3, 1, 5, 2, 5, 4, 2})},
                   {"material", 0}});
    return b;
  }
  TemporaryFolder folder;
};

TEST_F(TangentsOfFiles, AreMadeWhereAMapAsksAndVerticesDividedWhereTheyDisagree) {
  const Scene scene = mirrored().load(folder);
  const Material& material = scene.assets.materials[0];
  ASSERT_NE(material.normalTexture.image, kNone);
  EXPECT_FALSE(scene.assets.images[material.normalTexture.image].srgb);
  EXPECT_EQ(material.normalScale, 0.5f);
  const Mesh& mesh = scene.assets.meshes[0];
  ASSERT_EQ(mesh.positions.size(), 8u) << "1 and 2 are two each";
  ASSERT_EQ(mesh.tangents.size(), 8u);
  for (size_t t = 0; t < 4; ++t)
    for (int c = 0; c < 3; ++c) {
      const uint32_t v = mesh.triangles[t][c];
      expectTangent(mesh.tangents[v], {t < 2 ? 1 : -1, 0, 0}, t < 2 ? 1 : -1);
      EXPECT_EQ(mesh.uv0[v].x, t < 2 ? mesh.positions[v].x : 2 - mesh.positions[v].x);
    }
  GltfBuilder plain = mirrored();
  plain.json["materials"][0].erase("normalTexture");
  const Scene without = plain.load(folder);
  EXPECT_TRUE(without.assets.meshes[0].tangents.empty());
  EXPECT_EQ(without.assets.meshes[0].positions.size(), 6u);
}

/// Primitives that divide one set of vertices among them each have their own, and no others.
TEST_F(TangentsOfFiles, AreOfTheVerticesThatAPrimitiveUses) {
  GltfBuilder b = mirrored();
  nlohmann::json& primitives = b.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[0]["indices"] = b.indices({0, 1, 2, 0, 2, 3});
  primitives[1]["indices"] = b.indices({1, 5, 2, 5, 4, 2});
  const Scene scene = b.load(folder);
  const Mesh& mesh = scene.assets.meshes[0];
  ASSERT_EQ(mesh.positions.size(), 8u);
  for (size_t t = 0; t < 4; ++t)
    for (int c = 0; c < 3; ++c) {
      const uint32_t v = mesh.triangles[t][c];
      expectTangent(mesh.tangents[v], {t < 2 ? 1 : -1, 0, 0}, t < 2 ? 1 : -1);
      EXPECT_EQ(mesh.uv0[v].x, t < 2 ? mesh.positions[v].x : 2 - mesh.positions[v].x);
    }
}

TEST_F(TangentsOfFiles, AreTheFilesOwnWhereItHasNormalsToo) {
  GltfBuilder b = mirrored();
  nlohmann::json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TANGENT"] = b.floats(flat(std::vector<vec4>(6, {0, 3, 0, -1})), "VEC4");
  const Scene own = b.load(folder);
  ASSERT_EQ(own.assets.meshes[0].tangents.size(), 6u);
  for (const vec4& t : own.assets.meshes[0].tangents) expectTangent(t, {0, 1, 0}, -1);
  attributes.erase("NORMAL");
  const Scene made = b.load(folder);
  expectTangent(made.assets.meshes[0].tangents[0], {1, 0, 0}, 1);
}

TEST_F(TangentsOfFiles, FollowTheMapsOwnTransformOfCoordinates) {
  GltfBuilder b = mirrored();
  b.json["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"] = {{"rotation", kPi / 2}};
  const Scene scene = b.load(folder);
  // u' = v, v' = -u of the file's coordinates: u' grows downwards on the first half.
  expectTangent(scene.assets.meshes[0].tangents[0], {0, -1, 0}, 1);
}

TEST_F(TangentsOfFiles, AMapThatCannotBeDecodedIsNone) {
  GltfBuilder b = mirrored();
  b.json["images"][0] = {{"uri", "not-there.png"}};
  EXPECT_EQ(b.load(folder).assets.materials[0].normalTexture.image, kNone);
}

/// Seen from in front and from behind, placed by a mirroring matrix and by one that is not uniform.
TEST_F(TangentsOfFiles, MappedNormalsAreThoseOfASlantedSurface) {
  Scene scene = mirrored().load(folder);
  scene.assets.materials[0].metalness = 0;
  SceneExtractor extractor;
  const auto at = [&](const mat4& placed, uint32_t triangle, const vec3& towardsViewer) {
    SceneView view = extractor.extract(scene, {}, 0);
    std::vector<InstanceView> instances(view.instances.begin(), view.instances.end());
    instances[0].worldFromObject = placed;
    view.instances = instances;
    return mappedNormalAt(view, 0, 0, triangle, {0.3f, 0.3f}, vec3(0), towardsViewer);
  };
  const vec3 local(1, 1 / 255.0f * 0.5f, 1 / 255.0f); // of (255, 128, 128), x and y halved
  const vec3 slope = glm::normalize(vec3(0.5f, local.y, local.z));
  const auto expectNormal = [](const vec3& is, const vec3& wanted) { EXPECT_LT(glm::length(is - wanted), 1e-5f); };
  const vec3 front = glm::normalize(vec3(0.2f, 0, 1)), left = glm::normalize(vec3(-0.2f, 0, 1));
  expectNormal(at(mat4(1), 0, front), slope);
  expectNormal(at(mat4(1), 2, left), slope * vec3(-1, 1, 1));
  // A mirror image of the surface has the mirror image of its normals.
  const mat4 mirror = glm::scale(mat4(1), vec3(1, -1, 1));
  expectNormal(at(mirror, 0, front), slope * vec3(1, -1, 1));
  // From behind it is the same surface.
  const vec3 behind = glm::normalize(vec3(-0.2f, 0, -1));
  expectNormal(at(mat4(1), 0, behind), -slope);
  // Normals against the winding of their triangles are on the side that is seen, as the rasteriser has it.
  for (vec3& n : scene.assets.meshes[0].normals) n = -n;
  expectNormal(at(mat4(1), 0, left), slope * vec3(-1, 1, 1));
  for (vec3& n : scene.assets.meshes[0].normals) n = -n;
  // A slope that faces away is seen edge on, not through.
  const vec3 grazing = glm::normalize(vec3(-1, 0, 0.01f));
  EXPECT_GT(glm::dot(at(mat4(1), 0, grazing), grazing), 0);
  EXPECT_NEAR(glm::length(at(mat4(1), 0, grazing)), 1, 1e-5f);
  // One of metal that would mirror the viewer into the surface mirrors them along it: from either side, and half of the
  // way where half of it is metal.
  for (const vec3& viewer : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(-0.8f, 0.2f, 0.5f)}) {
    const vec3 towards = glm::normalize(viewer), geometric(0, 0, viewer.z > 0 ? 1.0f : -1.0f);
    const auto heightOf = [&](const vec3& n) { return glm::dot(glm::reflect(-towards, n), geometric); };
    scene.assets.materials[0].metalness = 0;
    const vec3 matt = at(mat4(1), 0, towards);
    ASSERT_LT(heightOf(matt), -0.1f);
    scene.assets.materials[0].metalness = 1;
    const vec3 metal = at(mat4(1), 0, towards);
    EXPECT_NEAR(heightOf(metal), 0.1f, 1e-4f);
    EXPECT_LT(glm::length(glm::cross(glm::cross(metal, geometric), glm::cross(matt, geometric))), 1e-4f);
    scene.assets.materials[0].metalness = 0.5f;
    expectNormal(at(mat4(1), 0, towards), glm::normalize(matt + metal));
  }
  scene.assets.materials[0].metalness = 1;
  expectNormal(at(mat4(1), 0, slope), slope);
}

/// Turned with their vertices; on the other side where a joint mirrors them; in the plane of normals that a morph
/// turned.
TEST(Tangents, FollowWhatDeformsTheirMesh) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, vec3(0, 0, 1));
  mesh.tangents.assign(3, vec4(1, 0, 0, 1));
  mesh.triangles = {{0, 1, 2}};
  mesh.primitives.push_back({0, 1, 0, {}});
  mesh.jointSets.push_back({std::vector(3, glm::uvec4(0)), std::vector(3, vec4(1, 0, 0, 0))});
  mesh.morphTargets.push_back({{}, std::vector(3, vec3(1, 0, 0))});
  DeformedMesh out;
  deform(mesh, {{glm::rotate(mat4(1), kPi / 2, vec3(0, 0, 1))}, {}}, out);
  for (const vec4& t : out.tangents) expectTangent(t, {0, 1, 0}, 1);
  deform(mesh, {{glm::scale(mat4(1), vec3(-2, 2, 2))}, {}}, out);
  for (const vec4& t : out.tangents) expectTangent(t, {-1, 0, 0}, -1);
  deform(mesh, {{}, {1}}, out); // normals between z and x
  for (const vec4& t : out.tangents) expectTangent(t, glm::normalize(vec3(1, 0, -1)), 1);
}

} // namespace lambent::test::tangents_test
