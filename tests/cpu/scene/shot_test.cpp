// Shot files: round trip, strictness, camera path, posing a scene.

#include "engine/scene/shot.h"
#include "tests/cpu/scene/support.h"
#include "tests/support/effort.h"

#include <ctime>

namespace lambent::test::shot_test {

const char* kShot = R"({
  "shot": 1, "scene": "models/room.glb", "unit": 0.01, "fps": 24, "seconds": 2.5,
  "camera": {"keys": [{"t": 0, "eye": [0, 1, 5], "target": [0, 1, 0], "fov": 60},
                      {"t": 2, "eye": [4, 1, 5], "target": [0, 1, 0]}]},
  "lights": {"lamp": {"keys": [{"t": 0, "intensity": [0, 0, 0], "direction": [0, -1, 0]},
                               {"t": 2, "intensity": [4, 2, 0], "direction": [1, 0, 0]}]}},
  "objects": {"door": {"keys": [{"t": 1, "rotation": [0, 90, 0]}, {"t": 0.5e1, "position": [1, 2, 3]}]}},
  "pixels": [[0.25, 0.75]],
  "set": {"smc.vpls": 4096, "technique": "smc", "filter.on": true}
})";

class ShotFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    writeBytes(folder / "path.json", text);
    return folder / "path.json";
  }
  void expectError(const std::string& text, const std::string& reason) {
    const auto file = write(text);
    const std::string error = inputErrorOf([&] { loadShot(file); });
    EXPECT_EQ(error.rfind(file.string() + ": ", 0), 0u) << error;
    EXPECT_NE(error.find(reason), std::string::npos) << error;
  }
  TemporaryFolder folder;
};

void expectShotsEqual(const Shot& a, const Shot& b) {
  EXPECT_EQ(a.scene.lexically_normal(), b.scene.lexically_normal());
  EXPECT_DOUBLE_EQ(a.unit, b.unit);
  EXPECT_DOUBLE_EQ(a.fps, b.fps);
  EXPECT_DOUBLE_EQ(a.seconds, b.seconds);
  ASSERT_EQ(a.camera.size(), b.camera.size());
  for (size_t i = 0; i < a.camera.size(); ++i) {
    EXPECT_DOUBLE_EQ(a.camera[i].t, b.camera[i].t);
    EXPECT_EQ(a.camera[i].eye, b.camera[i].eye);
    EXPECT_EQ(a.camera[i].target, b.camera[i].target);
    EXPECT_NEAR(a.camera[i].fovY, b.camera[i].fovY, 1e-6f);
  }
  for (const auto& [nodesA, nodesB] : {std::pair(&a.lights, &b.lights), std::pair(&a.objects, &b.objects)}) {
    ASSERT_EQ(nodesA->size(), nodesB->size());
    for (const auto& [name, keys] : *nodesA) {
      const auto& others = nodesB->at(name);
      ASSERT_EQ(keys.size(), others.size());
      for (size_t i = 0; i < keys.size(); ++i) {
        EXPECT_DOUBLE_EQ(keys[i].t, others[i].t);
        EXPECT_EQ(keys[i].position, others[i].position);
        EXPECT_EQ(keys[i].rotation, others[i].rotation);
        EXPECT_EQ(keys[i].direction, others[i].direction);
        EXPECT_EQ(keys[i].intensity, others[i].intensity);
      }
    }
  }
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_EQ(a.set, b.set);
}

TEST_F(ShotFile, IsReadAndWrittenWithoutLoss) {
  const Shot shot = loadShot(write(kShot));
  EXPECT_EQ(shot.scene, folder / "models/room.glb");
  EXPECT_EQ(shot.frameCount(), 60);
  ASSERT_EQ(shot.camera.size(), 2u);
  EXPECT_NEAR(shot.camera[1].fovY, kPi / 3, 1e-6f); // as the key before
  EXPECT_EQ(shot.set.at("smc.vpls"), "4096");
  EXPECT_EQ(shot.set.at("filter.on"), "true");
  std::filesystem::create_directory(folder / "elsewhere");
  const auto copy = folder / "elsewhere/copy.json";
  saveShot(shot, copy);
  expectShotsEqual(shot, loadShot(copy)); // the scene's path is made relative to the new place
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "elsewhere"), {}), 1); // no temporary left
}

TEST_F(ShotFile, ErrorsNamePlaceAndReason) {
  EXPECT_NE(inputErrorOf([&] { loadShot(folder / "none.json"); }).find("no such file"), std::string::npos);
  expectError("{\n\"shot\": 1,\n oops}", "line 3");
  expectError("[]", "is not an object");
  expectError("{}", "lacks the key 'shot'");
  expectError(R"({"shot": 2, "scene": "a", "seconds": 1})", "shot: is not a version");
  expectError(R"({"shot": 1, "scene": "a", "secnds": 1})", "unknown key 'secnds' (did you mean seconds?)");
  expectError(R"({"shot": 1, "scene": 7, "seconds": 1})", "scene: is not text");
  expectError(R"({"shot": 1, "scene": "a", "seconds": 1, "fps": 0})", "fps: is out of range");
  expectError(R"({"shot": 1, "scene": "a", "seconds": 1, "pixels": [[0, 1], [2, 0]]})", "pixels[1]: is outside");
  const auto camera = [](const std::string& keys) {
    return R"({"shot": 1, "scene": "a", "seconds": 1, "camera": {"keys": [)" + keys + "]}}";
  };
  expectError(R"({"shot": 1, "scene": "a", "seconds": 1, "seconds": 2})", "'seconds' twice");
  expectError(camera(R"({"t": 0, "eye": [1e13, 0, 1], "target": [0, 0, 1]})"), "eye: is farther than 1e12 m");
  expectError(camera(R"({"t": 0, "eye": [0, 0], "target": [0, 0, 1]})"),
              "camera.keys[0].eye: has 2 numbers (3 expected)");
  expectError(camera(R"({"t": 0, "eye": [0, 0, "x"], "target": [0, 0, 1]})"), "camera.keys[0].eye[2]: is not a number");
  expectError(camera(R"({"t": 0, "eye": [0, 0, 1], "target": [0, 0, 1]})"), "same point");
  expectError(camera(R"({"t": 0, "eye": [0, 0, 1], "target": [0, 0, 0], "fov": 180})"), "fov: is out of range");
  for (const char* t : {"-1e308", "1e10"})
    expectError(camera(std::string(R"({"t": )") + t + R"(, "eye": [0, 0, 1], "target": [0, 0, 0]})"),
                "camera.keys[0].t: is out of range");
  expectError(
      camera(
          R"({"t": 0, "eye": [0, 0, 1], "target": [0, 0, 0]}, {"t": 1e-308, "eye": [9, 0, 1], "target": [0, 0, 0]})"),
      "camera.keys[1].t: is not after");
  for (const char* direction : {"0", "1e-50", "1e20"})
    expectError(R"({"shot": 1, "scene": "a", "seconds": 1, "played": [{"t": 0, "torch": {"at": [0, 0, 0],
                "direction": [0, 0, )" +
                    std::string(direction) + R"(], "intensity": [1, 1, 1]}}]})",
                std::string("played[0].torch.direction: ") +
                    (direction == std::string("1e20") ? "is longer" : "has no"));
  expectError(
      camera(R"({"t": 1, "eye": [0, 0, 1], "target": [0, 0, 0]}, {"t": 1, "eye": [0, 0, 1], "target": [0, 0, 0]})"),
      "camera.keys[1].t: is not after");
  expectError(
      R"({"shot": 1, "scene": "a", "seconds": 1, "objects": {"x": {"keys": [{"t": 0, "intensity": [1, 1, 1]}]}}})",
      "objects.x.keys[0]: unknown key 'intensity'");
  expectError(
      R"({"shot": 1, "scene": "a", "seconds": 1, "lights": {"x": {"keys": [{"t": 0, "intensity": [1, -1, 1]}]}}})",
      "negative");
}

/// Between two directions that are opposite there is none: the first holds.
TEST(PlayedAt, ATorchThatTurnsRoundHasADirection) {
  Shot shot;
  for (const float z : {-1.0f, 1.0f}) {
    PlayedMoment moment;
    moment.t = double(z);
    moment.torch = PlayedMoment::Torch{.direction = {0, 0, z}};
    shot.played.push_back(moment);
  }
  for (const double t : {-1.0, -0.5, 0.0, 0.5, 1.0}) EXPECT_EQ(std::abs(playedAt(shot, t).torch->direction.z), 1) << t;
}

TEST(ShotCamera, PassesThroughItsKeysAndHoldsOutside) {
  Shot shot;
  shot.camera = {{0, {0, 0, 0}, {0, 0, -1}, 1}, {1, {1, 2, 0}, {1, 0, -1}, 1}, {3, {5, 2, 1}, {5, 0, -1}, 2}};
  for (const CameraKey& key : shot.camera) {
    const CameraView view = shotCamera(shot, key.t, dvec3(0));
    expectNear(view.position(), key.eye);
    expectNear(-vec3(view.worldFromView[2]), glm::normalize(key.target - key.eye));
    EXPECT_FLOAT_EQ(view.fovY, key.fovY);
  }
  for (const auto& [t, key] : {std::pair(-1.0f, shot.camera.front()), {99.0f, shot.camera.back()}}) {
    const CameraView view = shotCamera(shot, t, dvec3(0));
    expectNear(view.position(), key.eye);
    expectNear(-vec3(view.worldFromView[2]), glm::normalize(key.target - key.eye));
    EXPECT_FLOAT_EQ(view.fovY, key.fovY);
  }
  EXPECT_FLOAT_EQ(shotCamera(shot, 2, dvec3(0)).fovY, 1.5f);
  // The speed is the same on both sides of a key.
  const float h = 1e-3f;
  const vec3 before = (shotCamera(shot, 1, dvec3(0)).position() - shotCamera(shot, 1 - h, dvec3(0)).position()) / h;
  const vec3 after = (shotCamera(shot, 1 + h, dvec3(0)).position() - shotCamera(shot, 1, dvec3(0)).position()) / h;
  expectNear(before, after, 0.02f);
  expectNear(before, vec3(5, 2, 1) / 3.0f, 0.02f); // the slope between the neighbours
}

TEST(PoseShot, MovesNodesLinearlyAndNamesThoseItLacks) {
  Scene scene;
  Registry& registry = scene.registry;
  const Entity hinge = registry.create(), lamp = registry.create();
  registry.emplace<Name>(hinge, "door");
  registry.emplace<Transform>(hinge).translation = vec3(1, 0, 0);
  registry.emplace<Name>(lamp, "lamp");
  registry.emplace<Transform>(lamp);
  registry.emplace<PunctualLight>(lamp);
  registry.emplace<Parent>(lamp, hinge);

  Shot shot;
  shot.file = "shot.json";
  shot.objects["door"] = {{0, {}, vec3(0, 0, 0), {}, {}}, {2, {}, vec3(0, 360, 0), {}, {}}};
  shot.lights["lamp"] = {{0, vec3(2, 0, 0), {}, vec3(0, -1, 0), vec3(0)},
                         {1, {}, {}, vec3(1, 0, 0), {}},
                         {2, vec3(2, 4, 0), {}, {}, vec3(4, 2, 0)}};
  SceneExtractor extractor;
  poseShot(scene, shot, 0.5);
  const SceneView view = extractor.extract(scene, {}, 0.5);
  ASSERT_EQ(view.lights.size(), 1u);
  expectNear(view.lights[0].position, {1, 1, -2}); // the door has turned +X to -Z; the lamp has risen by 1
  expectNear(view.lights[0].direction, glm::normalize(vec3(1, -1, 0))); // in world space, whatever the door does
  expectNear(view.lights[0].intensity, {1, 0.5f, 0});
  poseShot(scene, shot, 5);
  expectNear(extractor.extract(scene, {}, 5).lights[0].intensity, {4, 2, 0});

  shot.objects["dor"] = shot.objects["door"];
  EXPECT_NE(inputErrorOf([&] { poseShot(scene, shot, 0); }).find("'dor' (did you mean 'door'?)"), std::string::npos);
  shot.objects.erase("dor");
  shot.lights["door"] = shot.lights["lamp"]; // a node, but not a light
  EXPECT_NE(inputErrorOf([&] { poseShot(scene, shot, 0); }).find("no light called 'door'"), std::string::npos);
}

/// Each of 16 000 nodes is found at once, not by looking at all of them.
TEST(PoseShot, FindsManyNodes) {
  if (kSanitized) GTEST_SKIP() << "sanitizers have costs of their own";
  GltfBuilder b;
  Shot shot;
  constexpr int kNodes = 16000;
  for (int i = 0; i < kNodes; ++i) {
    b.addRoot({{"name", "node " + std::to_string(i)}});
    shot.objects["node " + std::to_string(i)].emplace_back().position = dvec3(i, 0, 0);
  }
  const TemporaryFolder folder;
  Scene scene = b.load(folder);
  const std::clock_t begin = std::clock();
  poseShot(scene, shot, 1);
  EXPECT_LT(double(std::clock() - begin) / CLOCKS_PER_SEC, 0.5) << "it took 2 s";
  EXPECT_EQ(scene.registry.get<WorldTransform>(*findByName(scene, "node 7")).worldFromNode[3].x, 7);
}

TEST(PoseShot, WhatEqualKeysHoldDoesNotMove) {
  Scene scene;
  Registry& registry = scene.registry;
  const Entity box = registry.create();
  registry.emplace<Name>(box, "box");
  registry.emplace<Transform>(box);
  const vec3 place(5.2f, 0.9f, -0.4f), turn(13.7f, 75.3f, -8.1f);
  Shot shot;
  shot.objects["box"] = {{0, place, turn, {}, {}}, {1, place, turn, {}, {}}, {3, place, turn, {}, {}}};
  for (const double t : {0.0, 1.0, 3.0}) shot.camera.push_back({t, place, turn, 1.1f});
  poseShot(scene, shot, 0);
  const dmat4 before = registry.get<WorldTransform>(box).worldFromNode;
  const CameraView camera = shotCamera(shot, 0, dvec3(0));
  for (int frame = 1; frame < 100; ++frame) {
    poseShot(scene, shot, frame / 30.0);
    EXPECT_EQ(registry.get<WorldTransform>(box).worldFromNode, before) << frame;
    EXPECT_EQ(shotCamera(shot, frame / 30.0, dvec3(0)).worldFromView, camera.worldFromView) << frame;
    EXPECT_EQ(shotCamera(shot, frame / 30.0, dvec3(0)).fovY, camera.fovY) << frame;
  }
}

} // namespace lambent::test::shot_test
