// What a ray has to look at in the mean: scenes whose first picture would take minutes are refused, others are not.
#include "engine/scene/ray_work.h"

#include "engine/core/error.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "engine/scene/placed_triangles.h"
#include "tests/cpu/scene/support.h"

#include <sys/resource.h>

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

/// The sides of a box with their fronts inward, half of that size along each axis.
std::vector<vec3> sidesFromInside(const vec3& half) {
  std::vector<vec3> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const auto corner = [&](float u, float v) {
        vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = -side * u; // the other way round on the other side
        p[(axis + 2) % 3] = v;
        return p * half;
      };
      for (const vec2 c : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1)})
        corners.push_back(corner(c.x, c.y));
    }
  return corners;
}

/// A room of 6 x 4 x 6 m around the origin.
GltfBuilder room() {
  GltfBuilder b;
  b.addMeshNode({{"attributes", {{"POSITION", b.positions(sidesFromInside({3, 2, 3}))}}}});
  return b;
}

/// A mesh of these triangles, not yet shown.
int meshOf(GltfBuilder& b, const std::vector<vec3>& corners, int material = -1) {
  nlohmann::json primitive = {{"attributes", {{"POSITION", b.positions(corners)}}}};
  if (material >= 0) primitive["material"] = material;
  return b.push("meshes", {{"primitives", {primitive}}});
}

/// Two triangles across the room at Z = 0.
const std::vector<vec3> kAcross{{-3, -2, 0}, {3, -2, 0}, {3, 2, 0}, {-3, -2, 0}, {3, 2, 0}, {-3, 2, 0}};

/// 100 000 instances all over a cube: a line through it asks for few of their boxes, in whatever order they are.
TEST(PlacedTriangles, ALineAsksForFewOfManyInstances) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  GltfBuilder b;
  const int mesh = meshOf(b, {{0, 0, 0}, {2, 0, 2}, {0, 2, 0}});
  std::vector<vec3> places;
  Rng random(1, Stream::Test, 0);
  for (int i = 0; i < 100000; ++i) places.push_back(100.0f * random.next3());
  const int translations = b.positions(places);
  b.json["nodes"] = {
      {{"mesh", mesh},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translations}}}}}}}}};
  b.json["scenes"] = {{{"nodes", {0}}}};
  b.json["scene"] = 0;
  const Scene scene = b.load(TemporaryFolder(), {.large = true});
  PlacedTriangles placed(scene);
  size_t asked = 0, visited = 0, hit = 0;
  const auto wanted = [&](const Aabb& box) {
    ++asked;
    return entry(box, vec3(-1, 50, 50), vec3(1, 0, 0), 0, kInfinity).has_value();
  };
  placed.forEachBlock(wanted, [&](const TriangleBlock&) { ++visited; });
  const vec3 from(-1, 50, 50), along(1, 0, 0);
  forEachPosed(scene, [&](const Mesh& m, const DeformedMesh*, const mat4& worldFromObject) {
    hit += entry(transformed(m.boundsObject, worldFromObject), from, along, 0, kInfinity).has_value();
  });
  EXPECT_GT(hit, 0);
  EXPECT_EQ(visited, hit);
  EXPECT_LT(asked, 20000);
  size_t all = 0;
  placed.forEachBlock([](const Aabb&) { return true; },
                      [&](const TriangleBlock& block) { all += block.triangles.size(); });
  EXPECT_EQ(all, 100000);
}

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
  for (int i = 0; i < 300; ++i) corners.insert(corners.end(), {{-3, -2, -3}, {3, 2, 3}, {3, 2, 2.99f}});
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
  EXPECT_EQ(refusalOf(sheets(15, 0.1f, 0.1f)), "");
  const GltfBuilder b = sheets(200, 0.02f, 0.1f, "BLEND");
  const std::string said = refusalOf(b);
  EXPECT_NE(said.find("that are cut out or blended"), std::string::npos) << said;
  EXPECT_NE(said.find("(most from "), std::string::npos) << said;
  EXPECT_NE(said.find("--allow-large"), std::string::npos) << said;
  EXPECT_NO_THROW(b.load(TemporaryFolder(), {.large = true}));
}

TEST(RayWork, IsToldToWhoDraws) {
  const Scene scene = sheets(20, 0.1f, 0.1f).load(TemporaryFolder(), {.large = true});
  EXPECT_GT(scene.rayWork, 5);
  EXPECT_EQ(SceneExtractor().extract(scene, {}, 0).rayWork, scene.rayWork);
  EXPECT_EQ(scene.rayWork, rayWork(scene).sum());
}

TEST(RayWork, NeedlesAreRefusedFromSoManyOn) {
  const auto needles = [](int count) {
    GltfBuilder b = room();
    std::vector<vec3> corners;
    for (int i = 0; i < count; ++i) corners.insert(corners.end(), {{-3, -2, -3}, {3, 2, 3}, {3, 2, 2.99f}});
    b.addRoot({{"mesh", meshOf(b, corners)}});
    return refusalOf(b);
  };
  EXPECT_EQ(needles(130), "");
  EXPECT_NE(needles(180), "");
}

/// Each has a map in the first frame.
TEST(RayWork, ThousandsOfLightsAreRefusedUnlessTheFileIsTrusted) {
  GltfBuilder b = room();
  b.json["extensionsUsed"] = {"KHR_lights_punctual"};
  b.json["extensions"]["KHR_lights_punctual"]["lights"].push_back({{"type", "point"}});
  const nlohmann::json node = {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}};
  for (int i = 0; i < 2010; ++i) b.addRoot(node);
  EXPECT_EQ(refusalOf(b), "");
  b.addRoot(node);
  EXPECT_NE(refusalOf(b).find("2011 lights"), std::string::npos);
  EXPECT_NO_THROW(b.load(TemporaryFolder(), {.large = true}));
}

/// And in each map all triangles are drawn.
TEST(RayWork, LightsOfManyTrianglesAreRefusedFromFewerOn) {
  GltfBuilder b;
  std::vector<vec3> corners; // a floor of 20 000 triangles
  for (int i = 0; i < 20000; ++i) {
    const vec3 at(i % 100, 0, i / 100);
    corners.insert(corners.end(), {at, at + vec3(0, 0, 0.9f), at + vec3(0.9f, 0, 0)});
  }
  b.addRoot({{"mesh", meshOf(b, corners)}});
  b.json["extensionsUsed"] = {"KHR_lights_punctual"};
  b.json["extensions"]["KHR_lights_punctual"]["lights"].push_back({{"type", "point"}});
  for (int i = 0; i < 500; ++i) b.addRoot({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  EXPECT_EQ(refusalOf(b), "");
  for (int i = 0; i < 50; ++i) b.addRoot({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  EXPECT_NE(refusalOf(b).find("a shadow map of 20000 triangles"), std::string::npos) << refusalOf(b);
}

/// Half of a mesh is cut out, the other half in front of it is not: which is which is said by primitives.
TEST(RayWork, LooksUpTheMaterialOfATriangle) {
  for (const bool maskedFirst : {true, false}) {
    GltfBuilder b = room();
    const int masked =
        b.push("materials", {{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.1f}}}}});
    const int whole = b.push("materials", {{"doubleSided", true}});
    nlohmann::json primitives;
    for (const bool cutOut : {maskedFirst, !maskedFirst}) {
      std::vector<vec3> corners;
      for (int i = 0; i < 20; ++i)
        for (const vec3& c : kAcross) corners.push_back(c + vec3(0, 0, 0.1f * float(i) + (cutOut ? 0.05f : 0)));
      primitives.push_back(
          {{"attributes", {{"POSITION", b.positions(corners)}}}, {"material", cutOut ? masked : whole}});
    }
    b.addRoot({{"mesh", b.push("meshes", {{"primitives", primitives}})}});
    const float passed = workOf(b).cutOut;
    EXPECT_GT(passed, 0.1f) << maskedFirst;
    EXPECT_LT(passed, 1) << "a whole one is behind each";
  }
}

/// Seen from outside closed things are little, however many lie in one place, mirrored or not.
TEST(RayWork, NobodyLooksIntoClosedThings) {
  for (const double mirrored : {1.0, -1.0}) {
    GltfBuilder b = room();
    const int mesh = meshOf(b, sidesFromInside({-0.2f, 0.2f, 0.2f})); // turned inside out
    for (int i = 0; i < 300; ++i) b.addRoot({{"mesh", mesh}, {"translation", {2, 0, 2}}, {"scale", {mirrored, 1, 1}}});
    EXPECT_LT(workOf(b).boxes, 60) << mirrored;
  }
}

/// A ray that meets a back stays in front of it: nobody is led through walls.
TEST(RayWork, StaysInTheSpaceThatARayCameThrough) {
  GltfBuilder b = room();
  std::vector<vec3> sheet;
  for (const vec3& c : kAcross) sheet.push_back(c + vec3(0, 0, 2.9f)); // with its front to the gap behind it
  std::vector<vec3> needles;
  for (int i = 0; i < 300; ++i) needles.insert(needles.end(), {{-3, -2, 2.91f}, {3, 2, 2.99f}, {3, 1.99f, 2.99f}});
  b.addRoot({{"mesh", meshOf(b, sheet)}});
  b.addRoot({{"mesh", meshOf(b, needles)}});
  EXPECT_LT(workOf(b).boxes, 100);
}

/// Walls end rays wherever the room stands, and however far off something else is.
TEST(RayWork, IsTheSameFarOffAndBesideWhatIsFar) {
  const float alone = workOf(sheets(10, 0.1f, 0.1f)).sum();
  GltfBuilder far = sheets(10, 0.1f, 0.1f);
  for (nlohmann::json& node : far.json["nodes"]) {
    dvec3 at(0);
    if (node.contains("translation")) at.z = node["translation"][2];
    node["translation"] = {70 + at.x, 80 + at.y, 90 + at.z}; // within 16 diameters, where the origin stays
  }
  EXPECT_NEAR(workOf(far).sum(), alone, 0.2f * alone);
  GltfBuilder beside = sheets(10, 0.1f, 0.1f);
  beside.addRoot({{"mesh", meshOf(beside, {{1e6f, 1e6f, 0}, {1e6f, 1e6f, 1}, {1e6f, 1e6f + 1, 0}})}});
  EXPECT_NEAR(workOf(beside).sum(), alone, 0.2f * alone);
}

/// What is small beside the floor it stands on, but is what light is sent on from: by area it counts for nothing. The
/// camera looks at it from near by; `behind` are triangles of its own.
GltfBuilder pileOnAFloor(int copies, bool seen, int behind = 0) {
  GltfBuilder b;
  const std::vector<vec3> floor = {{-1000, 0, -1000}, {-1000, 0, 1000}, {1000, 0, 1000},
                                   {-1000, 0, -1000}, {1000, 0, 1000},  {1000, 0, -1000}};
  b.addRoot({{"mesh", meshOf(b, floor)}});
  const int box = meshOf(b, sidesFromInside({-0.5f, 1, 0.5f})); // turned inside out
  for (int i = 0; i < copies; ++i) b.addRoot({{"mesh", box}, {"translation", {0, 1, 0}}});
  std::vector<vec3> layers;
  for (int i = 0; i < behind; ++i)
    for (const vec3& c : kAcross) layers.push_back(0.1f * c + vec3(0, 1, 0.6f + 1e-5f * float(i)));
  if (behind > 0) {
    const int masked =
        b.push("materials", {{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.1f}}}}});
    b.addRoot({{"mesh", meshOf(b, layers, masked)}});
  }
  const int camera = b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.3}, {"znear", 0.1}}}});
  b.addRoot({{"camera", camera}, {"translation", {0, 1, seen ? 5 : 950}}});
  return b;
}

TEST(RayWork, CountsWhereLightsArePut) {
  EXPECT_LT(workOf(pileOnAFloor(1500, false)).boxes, 40) << "seen from far off it is little";
  EXPECT_GT(workOf(pileOnAFloor(1500, true)).boxes, 120) << "many begin at a side that is there 1500 times";
  EXPECT_NE(refusalOf(pileOnAFloor(4000, true)), "");
}

/// The file's first camera is not the one that a person looks through.
TEST(RayWork, CountsFromTheCameraInUse) {
  Scene scene = pileOnAFloor(4000, false).load(TemporaryFolder());
  const float before = scene.rayWork;
  CameraView camera = sceneCameras(scene).front().view;
  EXPECT_NO_THROW(requireQuickRays(scene, camera, {}));
  EXPECT_EQ(scene.rayWork, before);
  camera.worldFromView[3].z = 5;
  EXPECT_THROW(requireQuickRays(scene, camera, {}), InputError);
  EXPECT_NO_THROW(requireQuickRays(scene, camera, {.large = true}));
  EXPECT_GT(scene.rayWork, 120) << "told to who draws";
}

/// A stack of sheets is one from before it, mirrored or not, and as many as there are from behind it.
TEST(RayWork, CountsBacksThatTheCameraLooksThrough) {
  const auto passed = [](bool doubleSided, bool behind, float scale) {
    GltfBuilder b;
    const int sheet = meshOf(b, kAcross, b.push("materials", {{"doubleSided", doubleSided}}));
    for (int i = 0; i < 40; ++i)
      b.addRoot({{"mesh", sheet}, {"translation", {0, 0, 0.01f * float(i)}}, {"scale", {scale, 1, 1}}});
    const int camera = b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.3}, {"znear", 0.1}}}});
    b.addRoot({{"camera", camera},
               {"translation", {0, 0, behind ? -5 : 5}},
               {"rotation", {0, behind ? 1 : 0, 0, behind ? 0 : 1}}});
    return workOf(b).boxes;
  };
  for (const float scale : {1.0f, -1.0f}) {
    EXPECT_LT(passed(false, false, scale), 5);
    EXPECT_EQ(passed(false, true, scale), 40);
    EXPECT_LT(passed(true, true, scale), 5);
  }
}

/// Nor need it be seen, or be met by many rays of what is seen.
TEST(RayWork, CountsWhereLightsArePutThatFewRaysMeet) {
  GltfBuilder b = pileOnAFloor(1500, true);
  nlohmann::json& camera = b.json["nodes"].back();
  camera["translation"] = {10, 5, 0};
  camera["rotation"] = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}; // down, at the floor beside it
  EXPECT_GT(workOf(b).boxes, 120);
}

/// A picture of nothing but layers that are cut out; rays that only lead somewhere keep no lists of them.
TEST(RayWork, CountsWhatFillsThePictureAndNeedsLittleMemory) {
  rusage before{}, after{};
  const GltfBuilder b = pileOnAFloor(1, true, 20000);
  const Scene scene = b.load(TemporaryFolder(), {.large = true});
  getrusage(RUSAGE_SELF, &before);
  EXPECT_GT(rayWork(scene).sum(), 1000);
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 300 << 10) << "KiB";
}

/// A tenth of a scene's area decides little, of however many triangles it is.
TEST(RayWork, PlacesAreDrawnByArea) {
  GltfBuilder b = sheets(30, 0.1f, 0.1f);
  const float alone = workOf(b).sum();
  std::vector<vec3> specks;
  for (int i = 0; i < 30000; ++i) {
    const vec3 at(20 + 0.01f * float(i % 170), 0.01f * float(i / 170), 0);
    specks.insert(specks.end(), {at, at + vec3(0.005f, 0, 0), at + vec3(0, 0.005f, 0)});
  }
  b.addRoot({{"mesh", meshOf(b, specks)}});
  EXPECT_NEAR(workOf(b).sum(), alone, 0.25f * alone);
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
  for (int i = 0; i < 250; ++i) b.addRoot({{"mesh", mesh}, {"translation", {2, -1, 2}}});
  EXPECT_EQ(refusalOf(b), "");
}

/// Random ones too, of which each ray enters others.
TEST(RayWork, NeedlesThroughEverythingAreRefused) {
  GltfBuilder b = room();
  std::vector<vec3> corners;
  Rng random(3, Stream::RayWork, 0);
  const auto next = [&] { return vec3(6, 4, 6) * (random.next3() - 0.5f); };
  for (int i = 0; i < 20000; ++i) {
    const vec3 from = next(), to = next();
    corners.insert(corners.end(), {from, to, to + vec3(0.01f, 0, 0.01f)});
  }
  b.addRoot({{"mesh", meshOf(b, corners)}});
  EXPECT_NE(refusalOf(b).find("looks at"), std::string::npos);
}

} // namespace lambent::test::ray_work_test
