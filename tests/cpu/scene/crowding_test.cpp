// Triangles in one place, or cut-out ones behind one another, cost every ray: found, and refused where they are too
// many.
#include "engine/scene/crowding.h"
#include "engine/scene/see_through.h"

#include "engine/core/rng.h"
#include "tests/cpu/scene/support.h"

namespace lambent::test::crowding_test {

/// A triangle of 1 m so many times, each `step` metres beside the one before.
GltfBuilder triangles(int count, float step) {
  GltfBuilder b = oneTriangle();
  for (int i = 1; i < count; ++i) b.addRoot({{"mesh", 0}, {"translation", {step * float(i), 0, step * float(i)}}});
  return b;
}

bool isCrowded(const GltfBuilder& b, int most) { return crowdedPlace(b.load(TemporaryFolder()), most).has_value(); }

TEST(Crowding, CountsTrianglesInOnePlace) {
  EXPECT_FALSE(crowdedPlace(Scene{}, 0));
  EXPECT_TRUE(isCrowded(triangles(100, 0), 99));
  EXPECT_FALSE(isCrowded(triangles(100, 0), 100));
  EXPECT_TRUE(isCrowded(triangles(100, 1e-5f), 99)) << "layers a hair apart";
  EXPECT_FALSE(isCrowded(triangles(100, 3), 1));
}

TEST(Crowding, SaysWhere) {
  GltfBuilder b = triangles(1, 0);
  for (int i = 0; i < 100; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, 0, 50 + 4 * i}}});
  for (int i = 0; i < 100; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, 70, 0}}});
  const Scene scene = b.load(TemporaryFolder());
  const std::optional<vec3> place = crowdedPlace(scene, 99);
  ASSERT_TRUE(place);
  EXPECT_NEAR(glm::distance(dvec3(*place) + scene.origin, dvec3(0, 70, 0)), 0, 1);
}

TEST(Crowding, OneTriangleInTwoHundredIsFoundAmongMoreThanAreLookedAt) {
  GltfBuilder b = triangles(30000, 3);
  for (int i = 0; i < 150; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, -5, 0}}});
  EXPECT_TRUE(isCrowded(b, 120));
  EXPECT_FALSE(isCrowded(b, 151));
}

/// Triangles of no area come from targets: others are left out when they are read.
TEST(Crowding, LinesAreNone) {
  for (const float flattened : {0.0f, 1.0f}) {
    GltfBuilder b;
    const int corners = b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), moves = b.positions({{}, {}, {0, -1, 0}});
    b.addMeshNode({{"attributes", {{"POSITION", corners}}}, {"targets", {{{"POSITION", moves}}}}});
    b.json["meshes"][0]["weights"] = {flattened};
    for (int i = 0; i < 100; ++i) b.addRoot({{"mesh", 0}});
    EXPECT_EQ(isCrowded(b, 2), flattened == 0);
  }
}

/// Sides of poles, each with a triangle's two halves; radius and length in metres, along X.
GltfBuilder poles(const std::vector<vec2>& places, int sides, float radius, float length) {
  GltfBuilder b;
  std::vector<vec3> corners;
  for (const vec2& place : places)
    for (int i = 0; i < sides; ++i) {
      const auto at = [&](int side, float x) {
        const float angle = 2 * kPi * float(side) / float(sides);
        return vec3(x, place.x + radius * std::cos(angle), place.y + radius * std::sin(angle));
      };
      const vec3 a = at(i, 0), b1 = at(i + 1, 0), c = at(i + 1, length), d = at(i, length);
      corners.insert(corners.end(), {a, b1, c, a, c, d});
    }
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(corners)}}}});
  return b;
}

/// They are long and thin, and side by side.
TEST(Crowding, PolesCablesAndWiresAreNone) {
  EXPECT_FALSE(isCrowded(poles({vec2(0)}, 128, 0.05f, 10), 16));
  EXPECT_FALSE(
      isCrowded(poles({{0, 0}, {0.02f, 0}, {-0.02f, 0}, {0, 0.02f}, {0, -0.02f}, {0.02f, 0.02f}}, 16, 0.01f, 10), 16));
  std::vector<vec2> tray;
  for (int i = 0; i < 14; ++i) tray.emplace_back(0.014f * float(i), 0);
  EXPECT_FALSE(isCrowded(poles(tray, 8, 0.006f, 10), 16));
}

/// Boxes of what is long and slanted lie over one another, and no ray meets them all.
TEST(Crowding, SlantedBoardsAreNone) {
  GltfBuilder b;
  b.addMeshNode({{"attributes", {{"POSITION", b.positions({{0, 0, 0}, {4, 0, 0}, {0, 0, 0.09f}})}}}});
  const float half = 0.38268343f; // of 45 degrees
  for (int i = 0; i < 400; ++i)
    b.addRoot({{"mesh", 0},
               {"rotation", {0, half, 0, 0.92387953f}},
               {"translation", {0.0707f * float(i), 0, 0.0707f * float(i)}}});
  EXPECT_FALSE(isCrowded(b, 10));
}

TEST(Crowding, InstancesOfACrowdCountEachAndTooManyAreRefused) {
  GltfBuilder b = oneTriangle();
  for (int i = 0; i < 31; ++i) b.json["meshes"][0]["primitives"].push_back(b.json["meshes"][0]["primitives"][0]);
  for (int i = 0; i < 5; ++i) b.addRoot({{"mesh", 0}});
  EXPECT_TRUE(isCrowded(b, 191));
  b.addRoot({{"mesh", 0}});
  const std::string said = inputErrorOf([&] { b.load(TemporaryFolder()); });
  EXPECT_NE(said.find("more than 192 triangles in one place, at "), std::string::npos) << said;
}

/// Large slanted sheets, one above the other: each holds the others' places in its box, and within its edges seen from
/// above.
TEST(Crowding, SheetsApartAreNone) {
  GltfBuilder b;
  b.addMeshNode({{"attributes", {{"POSITION", b.positions({{0, 0, 0}, {0, 0, 5}, {5, 5, 0}})}}}});
  for (int i = 1; i < 40; ++i) b.addRoot({{"mesh", 0}, {"translation", {-0.1f * float(i), 0.1f * float(i), 0}}});
  EXPECT_FALSE(isCrowded(b, 2));
}

/// Needles from end to end of the scene have all places in their boxes. The check takes as long as they are many.
TEST(Crowding, NeedlesThroughEverythingAreNone) {
  GltfBuilder b;
  std::vector<vec3> corners;
  Rng random(3, Stream::Crowding, 0);
  const auto next = [&] { return 10.0f * random.next3(); };
  for (int i = 0; i < 20000; ++i) {
    const vec3 from = next(), to = next();
    corners.insert(corners.end(), {from, to, to + vec3(0.01f, 0, 0.01f)});
  }
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(corners)}}}});
  EXPECT_FALSE(isCrowded(b, 192));
}

/// Squares of 1 m so many times, 3 cm apart; masked, with this alpha under a cutoff of a half.
GltfBuilder layers(int count, float alpha) {
  GltfBuilder b;
  b.push("materials", {{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}});
  const std::vector<vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(corners)}}}, {"material", 0}});
  for (int i = 1; i < count; ++i) b.addRoot({{"mesh", 0}, {"translation", {0, 0, 0.03f * float(i)}}});
  return b;
}

TEST(SeeThrough, CountsLayersThatAreCutOut) {
  EXPECT_EQ(seeThrough(Scene{}, 1).layers, 0);
  EXPECT_EQ(seeThrough(oneTriangle().load(TemporaryFolder()), 1000).layers, 0);
  EXPECT_EQ(seeThrough(layers(50, 0.1f).load(TemporaryFolder()), 1000).layers, 50);
  EXPECT_EQ(seeThrough(layers(50, 0.9f).load(TemporaryFolder()), 1000).layers, 0);
}

/// What stands in front of them hides those behind, as it does from rays.
TEST(SeeThrough, EndsWhereItIsNotCutOut) {
  GltfBuilder b = layers(50, 0.1f);
  b.push("materials", {{"alphaMode", "MASK"}});
  nlohmann::json whole = b.json["meshes"][0];
  whole["primitives"][0]["material"] = 1;
  b.push("meshes", whole);
  for (int i = 0; i < 50; ++i) b.addRoot({{"mesh", 1}, {"translation", {0, 0, 0.03f * float(i) + 0.01f}}});
  EXPECT_LT(seeThrough(b.load(TemporaryFolder()), 1000).layers, 2);
}

TEST(SeeThrough, TooManyAreRefused) {
  layers(250, 0.1f).load(TemporaryFolder());
  const std::string said = inputErrorOf([&] { layers(270, 0.1f).load(TemporaryFolder()); });
  EXPECT_NE(said.find("more than 256 layers one behind the other that are cut out, at "), std::string::npos) << said;
}

} // namespace lambent::test::crowding_test
