// Skins and morph targets: closed forms of the vertices, what an extraction says of them, and malformed files.

#include "tests/cpu/scene/support.h"

#include <glm/gtc/matrix_transform.hpp>

namespace lambent::test::deform_test {

using nlohmann::json;

class Deform : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  SceneExtractor extractor;
  Scene scene;

  InstanceView instance() { return extractor.extract(scene, {}, 0).instances[0]; }
  /// World position of a vertex as the next extraction has it.
  vec3 vertex(size_t i) {
    const InstanceView v = instance();
    return vec3(v.worldFromObject * vec4(v.deformed->positions[i], 1));
  }
  vec3 normal(size_t i) {
    const InstanceView v = instance();
    return glm::normalize(glm::transpose(glm::inverse(mat3(v.worldFromObject))) * v.deformed->normals[i]);
  }
};

const quat kQuarterTurn = glm::angleAxis(0.5f * kPi, vec3(0, 0, 1));

/// A strip in the plane z = 0, vertices at (0 | 0.5, y) for y = 0, 1, 2 in rows, and normals +x. The lower row follows
/// the joint at the origin, the upper one its child at (0, 1, 0), the middle row both alike: by weights of 2 and 2.
struct Bar {
  GltfBuilder b;
  int node, lower, upper;

  Bar() {
    const int positions = b.positions({{0, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}, {0.5f, 1, 0}, {0, 2, 0}, {0.5f, 2, 0}});
    std::vector<vec3> x(6, vec3(1, 0, 0));
    const std::vector<uint8_t> joints = {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
    const int weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 2, 2, 0, 0, 2, 2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4");
    const json attributes = {{"POSITION", positions},
                             {"NORMAL", b.positions(x)},
                             {"JOINTS_0", b.accessor(b.view(joints), 5121, "VEC4", 6)},
                             {"WEIGHTS_0", weights}};
    node = b.addMeshNode({{"attributes", attributes}, {"indices", b.indices({0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4})}});
    lower = b.addRoot({{"name", "lower"}});
    upper = b.push("nodes", {{"name", "upper"}, {"translation", {0, 1, 0}}});
    b.json["nodes"][lower]["children"] = {upper};
    mat4 toLower(1), toUpper(1);
    toUpper[3] = vec4(0, -1, 0, 1);
    const int bind = b.accessor(b.view(std::vector<mat4>{toLower, toUpper}), 5126, "MAT4", 2);
    b.json["skins"] = {{{"joints", {lower, upper}}, {"inverseBindMatrices", bind}}};
    b.json["nodes"][node]["skin"] = 0;
  }
};

TEST_F(Deform, BentBarIsWhereItsJointsAre) {
  Bar bar;
  scene = bar.b.load(folder);
  EXPECT_TRUE(scene.warnings.empty());
  expectNear(vertex(5), {0.5f, 2, 0});
  scene.registry.get<Transform>(*findByName(scene, "upper")).rotation = kQuarterTurn;
  updateWorldTransforms(scene);
  // (x, y) → (1 - y, 1 + x) about the upper joint; the middle row half of that, half where it was.
  expectNear(vertex(0), {0, 0, 0});
  expectNear(vertex(1), {0.5f, 0, 0});
  expectNear(vertex(2), {0, 1, 0});
  expectNear(vertex(3), {0.25f, 1.25f, 0});
  expectNear(vertex(4), {-1, 1, 0});
  expectNear(vertex(5), {-1, 1.5f, 0});
  expectNear(normal(1), {1, 0, 0});
  expectNear(normal(3), {std::sqrt(0.5f), std::sqrt(0.5f), 0});
  expectNear(normal(5), {0, 1, 0});
  const InstanceView v = instance();
  expectNear(v.boundsWorld.lo, {-1, 0, 0});
  expectNear(v.boundsWorld.hi, {0.5f, 1.5f, 0});
  expectNear(worldBounds(scene).lo, {-1, 0, 0});
  expectNear(worldBounds(scene).hi, {0.5f, 1.5f, 0});
}

TEST_F(Deform, TheNodesOwnPlaceDoesNotMoveASkinnedMesh) {
  const std::vector<std::pair<const char*, json>> places = {{"translation", {9, 9, 9}},
                                                            {"rotation", {0, 0.6, 0, 0.8}},
                                                            {"scale", {-1, 2, 3}},
                                                            {"scale", {0, 0, 0}},
                                                            {"scale", {1, 0, 1}}};
  for (const auto& [property, value] : places) {
    SCOPED_TRACE(value.dump());
    Bar bar;
    bar.b.json["nodes"][bar.node][property] = value;
    scene = bar.b.load(folder);
    scene.registry.get<Transform>(*findByName(scene, "lower")).rotation = kQuarterTurn;
    updateWorldTransforms(scene);
    extractor = {};
    expectNear(vertex(1), {0, 0.5f, 0});
    expectNear(vertex(5), {-2, 0.5f, 0});
    expectNear(normal(5), {0, 1, 0});
  }
}

TEST_F(Deform, ASecondSetOfJointsCounts) {
  Bar bar;
  // Upper row: the first set's weight of 1 on the upper joint, the second's of 3 on the lower one.
  const std::vector<uint8_t> joints(24, 0);
  std::vector<float> weights(24, 0);
  weights[16] = weights[20] = 3;
  json& attributes = bar.b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_1"] = bar.b.accessor(bar.b.view(joints), 5121, "VEC4", 6);
  attributes["WEIGHTS_1"] = bar.b.floats(weights, "VEC4");
  scene = bar.b.load(folder);
  scene.registry.get<Transform>(*findByName(scene, "upper")).translation = {4, 1, 0};
  updateWorldTransforms(scene);
  expectNear(vertex(5), {1.5f, 2, 0});
  expectNear(vertex(3), {2.5f, 1, 0});
}

/// One triangle with two morph targets: +z by 2 for all vertices, and +x by 1 for the second one alone.
struct Face {
  GltfBuilder b;
  int node;

  explicit Face(bool normals = false) {
    json primitive = {{"attributes", {{"POSITION", b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}};
    json lift = {{"POSITION", b.positions(std::vector<vec3>(3, vec3(0, 0, 2)))}};
    if (normals) {
      primitive["attributes"]["NORMAL"] = b.positions(std::vector<vec3>(3, vec3(0, 0, 1)));
      lift["NORMAL"] = b.positions(std::vector<vec3>(3, vec3(1, 0, 0)));
    }
    const json stretch = {{"POSITION", b.positions({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}})}};
    primitive["targets"] = {lift, stretch};
    node = b.addMeshNode(primitive);
    b.json["meshes"][0]["weights"] = {0.5, 0};
  }
  /// Drives the weights by keys at 0, 1, 2 s.
  void animate(const char* interpolation, const std::vector<float>& values) {
    const int times = b.floats({0, 1, 2});
    b.animate(node, "weights", times, b.floats(values), interpolation);
  }
};

TEST_F(Deform, HalfAWeightIsHalfWay) {
  Face face(true);
  scene = face.b.load(folder);
  expectNear(vertex(1), {1, 0, 1});
  expectNear(normal(1), glm::normalize(vec3(0.5f, 0, 1)));
  face.b.json["nodes"][face.node]["weights"] = {0.25, -1}; // instead of the mesh's; any number will do
  scene = face.b.load(folder);
  extractor = {};
  expectNear(vertex(0), {0, 0, 0.5f});
  expectNear(vertex(1), {0, 0, 0.5f});
}

TEST_F(Deform, FacesWithoutNormalsTurnWithTheirVertices) {
  GltfBuilder b;
  json primitive = {{"attributes", {{"POSITION", b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}};
  primitive["targets"] = {{{"POSITION", b.positions({{0, 0, 0}, {-1, 0, 1}, {0, 0, 0}})}}}; // x axis to z axis
  b.addMeshNode(primitive);
  b.json["meshes"][0]["weights"] = {1};
  scene = b.load(folder);
  expectNear(normal(0), {-1, 0, 0});
  expectNear(normal(2), {-1, 0, 0});
}

TEST_F(Deform, ATriangleWithoutAreaMayGetOne) {
  GltfBuilder b;
  json primitive = {{"attributes", {{"POSITION", b.positions({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}})}}}};
  primitive["targets"] = {{{"POSITION", b.positions({{0, 0, 0}, {0, 0, 0}, {-2, 1, 0}})}}};
  b.addMeshNode(primitive);
  scene = b.load(folder);
  EXPECT_NEAR(glm::length(normal(0)), 1, 1e-5f); // none to be had, but a unit vector all the same
  scene.registry.get<MorphWeights>(Entity(0, 0)).weights = {1};
  expectNear(normal(0), {0, 0, 1});
}

TEST_F(Deform, WeightsFollowTheirKeys) {
  struct Case {
    const char* interpolation;
    std::vector<float> values; // two weights to a value
    float lift, stretch;       // at 0.5 s
  };
  const std::vector<Case> cases = {
      {"STEP", {0.1f, 0.2f, 1, 0, 0, 0}, 0.1f, 0.2f},
      {"LINEAR", {0, 0.2f, 1, 0.6f, 0, 0}, 0.5f, 0.4f},
      // Hermite at the middle: half the sum of the values, an eighth of the difference of the tangents. First key: out
      // tangents 0.8 and 0; second key: in tangents 0 and -0.4.
      {"CUBICSPLINE", {9, 9, 0, 0.2f, 0.8f, 0, 0, -0.4f, 1, 0.6f, 9, 9, 9, 9, 0, 0, 9, 9}, 0.6f, 0.45f},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.interpolation);
    Face face;
    face.animate(c.interpolation, c.values);
    scene = face.b.load(folder);
    EXPECT_TRUE(scene.warnings.empty());
    extractor = {};
    animate(scene, 2.5); // two seconds later it loops
    expectNear(vertex(1), {1 + c.stretch, 0, 2 * c.lift});
    animate(scene, 1);
    EXPECT_NEAR(vertex(0).z, 2, 1e-5f);
  }
}

TEST_F(Deform, AnExtractionTellsWhatWasReshaped) {
  Bar bar;
  bar.b.addMeshNode({{"attributes", {{"POSITION", bar.b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}});
  scene = bar.b.load(folder);
  SceneView view = extractor.extract(scene, {}, 0);
  ASSERT_EQ(view.instances.size(), 2u);
  EXPECT_FALSE(view.instances[0].reshaped);
  EXPECT_TRUE(view.changes.first);
  EXPECT_EQ(view.instances[1].deformed, nullptr);
  const Aabb before = view.instances[0].boundsWorld;
  const uint64_t revision = view.instances[0].deformed->revision;

  view = extractor.extract(scene, {}, 0);
  EXPECT_FALSE(view.instances[0].reshaped || view.instances[0].moved || view.changes.geometry);
  EXPECT_EQ(view.instances[0].deformed->revision, revision);

  scene.registry.get<Transform>(*findByName(scene, "upper")).rotation = kQuarterTurn;
  updateWorldTransforms(scene);
  view = extractor.extract(scene, {}, 0);
  EXPECT_TRUE(view.instances[0].reshaped && view.instances[0].moved && view.changes.geometry);
  EXPECT_FALSE(view.instances[1].reshaped || view.instances[1].moved || view.changes.instances);
  EXPECT_NE(view.instances[0].deformed->revision, revision);
  expectNear(view.instances[0].boundsWorldBefore.hi, before.hi);
  expectNear(view.instances[0].boundsWorld.hi, {0.5f, 1.5f, 0});

  view = extractor.extract(scene, {}, 0);
  EXPECT_FALSE(view.instances[0].reshaped || view.instances[0].moved || view.changes.geometry);

  scene.registry.remove<Skin>(Entity(0, 0)); // now rigid, in its bind pose
  view = extractor.extract(scene, {}, 0);
  EXPECT_EQ(view.instances[0].deformed, nullptr);
  EXPECT_TRUE(view.instances[0].reshaped && view.instances[0].moved);
  expectNear(view.instances[0].boundsWorld.hi, {0.5f, 2, 0});
}

TEST_F(Deform, AJointThatIsGoneLeavesItsPartInPlace) {
  Bar bar;
  scene = bar.b.load(folder);
  scene.registry.destroy(*findByName(scene, "upper"));
  expectNear(vertex(5), {0.5f, 2, 0});
}

TEST_F(Deform, ManyVerticesAreTheSameForAnyNumberOfThreads) {
  Mesh mesh;
  JointSet set;
  for (uint32_t i = 0; i < 20000; ++i) {
    mesh.positions.emplace_back(float(i % 97), float(i % 31), float(i));
    mesh.normals.push_back(glm::normalize(vec3(1, float(i % 5), 2)));
    set.joints.emplace_back(i % 3, 1, 0, 0);
    set.weights.emplace_back(0.75f, 0.25f, 0, 0);
    if (i >= 2) mesh.triangles.emplace_back(i - 2, i - 1, i);
  }
  mesh.jointSets.push_back(set);
  mesh.primitives.push_back({0, uint32_t(mesh.triangles.size()), 0, {}});
  Pose pose;
  for (int j = 0; j < 3; ++j)
    pose.objectFromBind.push_back(glm::rotate(mat4(1), 0.3f + float(j), glm::normalize(vec3(1, j, 2))));
  DeformedMesh one, many;
  setThreadCount(1);
  deform(mesh, pose, one);
  setThreadCount(0);
  deform(mesh, pose, many);
  EXPECT_EQ(one.positions, many.positions);
  EXPECT_EQ(one.normals, many.normals);
  EXPECT_EQ(one.boundsObject.hi, many.boundsObject.hi);
}

// Malformed files -----------------------------------------------------------------------------------------------------

class BadDeform : public Deform {
 protected:
  /// Loading gives one line that names the file and `what`.
  void expectError(const GltfBuilder& b, const std::string& what) {
    const std::string error = inputErrorOf([&] { b.load(folder); });
    EXPECT_NE(error.find("scene.gltf"), std::string::npos) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error << "\nshould tell: " << what;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
};

TEST_F(BadDeform, Skins) {
  const auto with = [](const char* pointer, const json& value) {
    Bar bar;
    bar.b.json[json::json_pointer(pointer)] = value;
    return bar.b;
  };
  expectError(with("/skins/0/joints", json{1}),
              "mesh 0, primitive 0, vertex 2: follows joint 1, but skin 0 of node 0 has 1");
  expectError(with("/skins/0/joints", json{1, 77}), "skin 0: refers to node 77");
  expectError(with("/scenes/0/nodes", json{0}), "skin 0: joint node 1 is not part of the scene");
  expectError(with("/accessors/5/count", 1), "skin 0: has fewer inverse bind matrices than joints");
  expectError(with("/accessors/5/type", "VEC4"), "inverse bind matrices, accessor");
  expectError(with("/accessors/3/count", 5), "JOINTS_0: has 5 elements, but there are 6 positions");
  expectError(with("/accessors/3/componentType", 5126), "JOINTS_0");
  expectError(with("/meshes/0/primitives/0/attributes/WEIGHTS_0", 99), "WEIGHTS_0: refers to accessor 99");

  for (const size_t element : {3u, 7u, 11u, 15u}) {
    Bar skewed;
    std::vector<mat4> binds(2, mat4(1));
    binds[1][int(element / 4)][int(element % 4)] = 0.5f;
    skewed.b.json["skins"][0]["inverseBindMatrices"] = skewed.b.accessor(skewed.b.view(binds), 5126, "MAT4", 2);
    expectError(skewed.b, "inverse bind matrix 1 is not affine");
  }

  Bar rigid;
  rigid.b.json["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0");
  scene = rigid.b.load(folder);
  EXPECT_TRUE(hasWarning(scene, "joints without weights, or of weights without joints"));
  EXPECT_TRUE(hasWarning(scene, "node 0: has a skin, but no vertex of its mesh follows a joint"));
  EXPECT_EQ(instance().deformed, nullptr);

  Bar broken;
  json& attributes = broken.b.json["meshes"][0]["primitives"][0]["attributes"];
  std::vector<float> weights(24, 0); // vertex 0 follows nothing
  for (size_t i = 4; i < 24; i += 4) weights[i] = 1;
  weights[5] = -1, weights[9] = std::numeric_limits<float>::quiet_NaN();
  weights[13] = kInfinity;
  attributes["WEIGHTS_0"] = broken.b.floats(weights, "VEC4");
  scene = broken.b.load(folder);
  EXPECT_TRUE(hasWarning(scene, "3 joint weight(s) that are negative or not a number"));
  extractor = {};
  expectNear(vertex(0), {0, 0, 0});
  expectNear(vertex(3), {0.5f, 1, 0});
}

TEST_F(BadDeform, MorphTargets) {
  const auto with = [](const char* pointer, const json& value) {
    Face face;
    face.animate("LINEAR", {0, 0, 0, 0, 0, 0});
    face.b.json[json::json_pointer(pointer)] = value;
    return face.b;
  };
  expectError(with("/meshes/0/weights", json{1}), "mesh 0: has 1 weights for 2 morph targets");
  expectError(with("/nodes/0/weights", json{1, 2, 3}), "node 0: has 3 weights for 2 morph targets");
  expectError(with("/nodes/0/weights", json{1, 1e300}), "node 0: weights hold a number beyond single precision");
  expectError(with("/accessors/1/count", 2), "morph target 0, POSITION: has 2 elements, but there are 3 positions");
  expectError(with("/meshes/0/primitives/0/targets/1/POSITION", 50), "morph target 1, POSITION: refers to accessor 50");
  expectError(with("/accessors/4/count", 5), "animation 0, channel 0: has 5 values for 3 keys (6 expected)");
  Face uneven;
  json second = uneven.b.json["meshes"][0]["primitives"][0];
  second["targets"].erase(1);
  uneven.b.json["meshes"][0]["primitives"].push_back(second);
  expectError(uneven.b, "mesh 0, primitive 1: has 1 morph targets, but primitive 0 has 2");

  GltfBuilder plain = oneTriangle();
  const int times = plain.floats({0});
  plain.animate(0, "weights", times, plain.floats({1}));
  EXPECT_TRUE(hasWarning(plain.load(folder), "weights of nodes without morph targets"));
}

TEST_F(BadDeform, KeysBeyondSinglePrecisionLeaveFiniteVertices) {
  Bar bar;
  const int times = bar.b.floats({0});
  bar.b.animate(bar.lower, "scale", times, bar.b.floats({3e38f, 3e38f, 3e38f}, "VEC3"));
  scene = bar.b.load(folder);
  const InstanceView v = instance();
  for (const vec3& p : v.deformed->positions) EXPECT_TRUE(isFinite(p));
  for (const vec3& n : v.deformed->normals) EXPECT_NEAR(glm::length(n), 1, 1e-4f);
}

} // namespace lambent::test::deform_test
