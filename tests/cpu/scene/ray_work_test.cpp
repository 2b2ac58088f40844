// What a ray has to look at in the mean: scenes whose first picture would take minutes are refused, others are not.
#include "engine/scene/ray_work.h"

#include "engine/core/error.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "tests/cpu/scene/support.h"

namespace lambent::test::ray_work_test {

RayWork workOf(const GltfBuilder& b) { return rayWork(b.load(TemporaryFolder(), {.large = true})); }
/// Empty where it is taken.
std::string refusalOf(const GltfBuilder& b) {
  try {
    b.load(TemporaryFolder());
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

/// A room of 6 x 4 x 6 m, seen from inside and outside.
GltfBuilder room() {
  GltfBuilder b;
  std::vector<vec3> corners;
  const vec3 lo(-3, 0, -3), hi(3, 4, 3);
  for (int axis = 0; axis < 3; ++axis)
    for (const float at : {lo[axis], hi[axis]}) {
      const auto corner = [&](bool u, bool v) {
        vec3 p;
        p[axis] = at;
        p[(axis + 1) % 3] = (u ? hi : lo)[(axis + 1) % 3];
        p[(axis + 2) % 3] = (v ? hi : lo)[(axis + 2) % 3];
        return p;
      };
      corners.insert(corners.end(),
                     {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 0), corner(1, 1), corner(0, 1)});
    }
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(corners)}}}});
  return b;
}

/// A mesh of these triangles, not yet shown.
int meshOf(GltfBuilder& b, const std::vector<vec3>& corners, int material = -1) {
  nlohmann::json primitive = {{"attributes", {{"POSITION", b.positions(corners)}}}};
  if (material >= 0) primitive["material"] = material;
  return b.push("meshes", {{"primitives", {primitive}}});
}

/// Two triangles across the room at Z = 0.
const std::vector<vec3> kAcross{{-3, 0, 0}, {3, 0, 0}, {3, 4, 0}, {-3, 0, 0}, {3, 4, 0}, {-3, 4, 0}};

TEST(RayWork, IsNothingOfNothingAndLittleOfARoom) {
  EXPECT_EQ(rayWork(Scene{}).sum(), 0);
  const RayWork work = workOf(room());
  EXPECT_GE(work.boxes, 1.5f); // it begins on a wall and ends on one; a wall's halves share its box
  EXPECT_LE(work.boxes, 8);
  EXPECT_EQ(work.cutOut, 0);
}

/// Every ray through the room enters the boxes of needles from corner to corner.
TEST(RayWork, CountsTrianglesThatARayCannotPassBy) {
  GltfBuilder b = room();
  std::vector<vec3> corners;
  for (int i = 0; i < 300; ++i) corners.insert(corners.end(), {{-3, 0, -3}, {3, 4, 3}, {3, 4, 3.01f}});
  b.addRoot({{"mesh", meshOf(b, corners)}});
  EXPECT_GT(workOf(b).boxes, 290);
  EXPECT_LT(workOf(b).boxes, 310);
}

/// What lies behind the end of a ray costs nothing, whichever comes first in the file.
TEST(RayWork, EndsWhereARayEnds) {
  for (const bool wallFirst : {true, false}) {
    GltfBuilder b;
    const int wall = meshOf(b, kAcross);
    if (wallFirst) b.addRoot({{"mesh", wall}});
    for (int i = 0; i < 200; ++i) b.addRoot({{"mesh", wall}, {"translation", {0, 0, -0.01f * float(i + 1)}}});
    if (!wallFirst) b.addRoot({{"mesh", wall}});
    EXPECT_LT(workOf(b).boxes, 4) << "each lies before the next";
  }
}

/// Sheets across a room, `apart` metres from one another; masked, with this alpha under a cutoff of a half.
GltfBuilder sheets(int count, float apart, float alpha, const char* mode = "MASK") {
  GltfBuilder b = room();
  const int material =
      b.push("materials", {{"alphaMode", mode}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}});
  const int mesh = meshOf(b, kAcross, material);
  for (int i = 0; i < count; ++i)
    b.addRoot({{"mesh", mesh}, {"translation", {0, 0, apart * (float(i) - 0.5f * float(count))}}});
  return b;
}

TEST(RayWork, CountsWhatIsPassedWhereItIsCutOut) {
  const RayWork work = workOf(sheets(50, 0.1f, 0.1f));
  EXPECT_GT(work.cutOut, 10) << "from wall to wall they are 50, from a sheet to its wall half of that";
  EXPECT_LT(work.cutOut, 50);
  EXPECT_EQ(workOf(sheets(50, 0.1f, 0.9f)).cutOut, 0) << "where it is not cut out it ends a ray";
}

TEST(RayWork, TooMuchIsRefusedAndSaysWhereUnlessTheFileIsTrusted) {
  EXPECT_EQ(refusalOf(sheets(10, 0.1f, 0.1f)), "");
  const GltfBuilder b = sheets(400, 0.01f, 0.1f, "BLEND");
  const std::string said = refusalOf(b);
  EXPECT_NE(said.find("that are cut out or blended"), std::string::npos) << said;
  EXPECT_NE(said.find("(most from "), std::string::npos) << said;
  EXPECT_NE(said.find("--allow-large"), std::string::npos) << said;
  EXPECT_NO_THROW(b.load(TemporaryFolder(), {.large = true}));
}

/// A ray meets the outermost of what lies in one place, and the whole place is seldom met.
TEST(RayWork, WhatIsParkedInACornerIsLittle) {
  GltfBuilder b = room();
  std::vector<vec3> ball;
  for (int i = 0; i < 64; ++i) {
    const vec3 a = sampleSphere(additiveRecurrence3(uint32_t(i), vec3(0))), c = glm::cross(a, vec3(0.3f, 0.5f, 0.8f));
    ball.insert(ball.end(), {0.2f * a, 0.2f * (a + 0.3f * c), 0.2f * (a - 0.3f * glm::cross(a, c))});
  }
  const int mesh = meshOf(b, ball);
  for (int i = 0; i < 250; ++i) b.addRoot({{"mesh", mesh}, {"translation", {2, 1, 2}}});
  EXPECT_EQ(refusalOf(b), "");
}

/// Of scenes that others have: the check takes its time from how many triangles there are, not from how they lie.
TEST(RayWork, NeedlesThroughEverythingAreRefused) {
  GltfBuilder b = room();
  std::vector<vec3> corners;
  Rng random(3, Stream::RayWork, 0);
  const auto next = [&] { return vec3(6, 4, 6) * random.next3() - vec3(3, 0, 3); };
  for (int i = 0; i < 20000; ++i) {
    const vec3 from = next(), to = next();
    corners.insert(corners.end(), {from, to, to + vec3(0.01f, 0, 0.01f)});
  }
  b.addRoot({{"mesh", meshOf(b, corners)}});
  EXPECT_NE(refusalOf(b).find("has to look at"), std::string::npos);
}

} // namespace lambent::test::ray_work_test
