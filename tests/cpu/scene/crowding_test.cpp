// Triangles in one place cost every ray: found, and refused where they are too many.
#include "engine/scene/crowding.h"

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

TEST(Crowding, PointsAndLinesAreNone) {
  GltfBuilder b = oneTriangle();
  std::vector<uint16_t> corners;
  for (int i = 0; i < 300; ++i) corners.insert(corners.end(), {0, 0, 0, 0, 1, 1});
  b.json["meshes"][0]["primitives"][0]["indices"] = b.indices(corners);
  b.addRoot({{"mesh", 0}});
  EXPECT_FALSE(isCrowded(b, 2));
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

} // namespace lambent::test::crowding_test
