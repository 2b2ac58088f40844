// Hierarchy, lights from outside, extraction and what it reports as changed.

#include "tests/cpu/scene/support.h"

namespace lambent::test::scene_test {

Entity addNode(Scene& scene, const vec3& translation, std::optional<Entity> parent = {}) {
  const Entity e = scene.registry.create();
  scene.registry.emplace<Transform>(e).translation = translation;
  if (parent) scene.registry.emplace<Parent>(e, *parent);
  return e;
}

/// Two placed triangles and a light.
struct SmallScene : ::testing::Test {
  SmallScene() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 2}};
    mesh.primitives = {{0, 1, 0, {}}};
    for (const vec3& p : mesh.positions) mesh.boundsObject.add(p);
    scene.assets.meshes.push_back(mesh);
    a = addNode(scene, {0, 0, 0});
    b = addNode(scene, {5, 0, 0});
    scene.registry.emplace<MeshInstance>(a, 0u);
    scene.registry.emplace<MeshInstance>(b, 0u);
    LightView l;
    l.position = vec3(0, 3, 0);
    light = addLight(scene, l, "lamp");
    updateWorldTransforms(scene);
  }
  SceneView extract() { return extractor.extract(scene, camera, 0); }

  Scene scene;
  SceneExtractor extractor;
  CameraView camera;
  Entity a, b, light;
};

TEST(Transforms, ChildrenFollowParentsInAnyOrderOfCreation) {
  Scene scene;
  const Entity child = addNode(scene, {1, 0, 0}), parent = addNode(scene, {0, 2, 0}), root = addNode(scene, {0, 0, 4});
  scene.registry.emplace<Parent>(child, parent);
  scene.registry.emplace<Parent>(parent, root);
  scene.registry.get<Transform>(root).scale = vec3(2);
  scene.registry.get<Transform>(parent).rotation = glm::angleAxis(kPi / 2, vec3(0, 0, 1));
  updateWorldTransforms(scene);
  const auto origin = [&](Entity e) { return vec3(scene.registry.get<WorldTransform>(e).worldFromNode[3]); };
  expectNear(origin(root), {0, 0, 4});
  expectNear(origin(parent), {0, 4, 4});
  expectNear(origin(child), {0, 6, 4}); // +X turned to +Y, scaled by 2
  scene.registry.destroy(root);         // its children become roots
  updateWorldTransforms(scene);
  expectNear(origin(child), {0, 3, 0});
}

TEST(TransformsTest, CyclesAreCaught) {
  Scene scene;
  const Entity a = addNode(scene, {}), b = addNode(scene, {}, a);
  scene.registry.emplace<Parent>(a, b);
  EXPECT_THROW(updateWorldTransforms(scene), CheckFailure);
}

TEST_F(SmallScene, FirstExtractionReportsEverythingThenNothing) {
  SceneView view = extract();
  EXPECT_TRUE(view.changes.first && view.changes.camera && view.changes.lights && view.changes.instances);
  ASSERT_EQ(view.instances.size(), 2u);
  expectNear(view.boundsWorld.hi, {6, 1, 0});
  expectNear(view.boundsWorld.hi, worldBounds(scene).hi);
  view = extract();
  EXPECT_FALSE(view.changes.first || view.changes.camera || view.changes.lights || view.changes.geometry ||
               view.changes.instances);
  EXPECT_FALSE(view.instances[0].moved || view.lights[0].changed);
}

TEST_F(SmallScene, MovingOneInstanceMarksOnlyIt) {
  extract();
  scene.registry.get<Transform>(b).translation.x = 7;
  updateWorldTransforms(scene);
  SceneView view = extract();
  EXPECT_TRUE(view.changes.geometry);
  EXPECT_FALSE(view.changes.lights || view.changes.instances || view.changes.camera);
  EXPECT_FALSE(view.instances[0].moved);
  EXPECT_TRUE(view.instances[1].moved);
  expectNear(vec3(view.instances[1].worldFromObjectBefore[3]), {5, 0, 0});
  expectNear(vec3(view.instances[1].worldFromObject[3]), {7, 0, 0});
  view = extract();
  EXPECT_FALSE(view.changes.geometry);
  EXPECT_EQ(view.instances[1].worldFromObjectBefore, view.instances[1].worldFromObject);
}

TEST_F(SmallScene, LightsSkyAndCameraAreToldApart) {
  extract();
  scene.registry.get<PunctualLight>(light).intensity = vec3(2);
  SceneView view = extract();
  EXPECT_TRUE(view.changes.lights && view.lights[0].changed);
  EXPECT_FALSE(view.changes.camera || view.changes.geometry);
  scene.sky = vec3(1);
  view = extract();
  EXPECT_TRUE(view.changes.lights);
  EXPECT_FALSE(view.lights[0].changed);
  EXPECT_FALSE(extract().changes.lights);
  scene.sky = Sky::daylight({0, 1, 0}, 3);
  EXPECT_TRUE(extract().changes.lights);
  scene.sky = Sky::daylight({0, 1, 0}, 3);
  EXPECT_FALSE(extract().changes.lights);
  scene.sky = Sky::daylight({0, 1, 0}, 4);
  EXPECT_TRUE(extract().changes.lights);
  camera.width = 640;
  EXPECT_TRUE(extract().changes.camera);
  scene.registry.destroy(light);
  EXPECT_TRUE(extract().changes.lights);
}

TEST_F(SmallScene, AddedAndRemovedInstancesKeepTheOthersOrder) {
  const uint32_t idOfB = extract().instances[1].id;
  scene.registry.destroy(a);
  SceneView view = extract();
  EXPECT_TRUE(view.changes.instances);
  EXPECT_FALSE(view.changes.geometry);
  ASSERT_EQ(view.instances.size(), 1u);
  EXPECT_EQ(view.instances[0].id, idOfB);
  const Entity c = addNode(scene, {1, 1, 1});
  scene.registry.emplace<MeshInstance>(c, 0u);
  updateWorldTransforms(scene);
  view = extract();
  EXPECT_TRUE(view.changes.instances);
  EXPECT_FALSE(view.instances[1].moved);
}

TEST_F(SmallScene, FlattenedInstancesStayInvertibleAndVanishedOnesAreLeftOut) {
  scene.registry.get<Transform>(a).scale = vec3(1, 1, 0);
  scene.registry.get<Transform>(b).scale = vec3(0);
  updateWorldTransforms(scene);
  const SceneView view = extract();
  ASSERT_EQ(view.instances.size(), 1u);
  const mat4& m = view.instances[0].worldFromObject;
  EXPECT_GT(std::abs(glm::determinant(mat3(m))), 0);
  const vec3 normal = glm::normalize(glm::transpose(glm::inverse(mat3(m))) * vec3(0, 0, 1));
  expectNear(glm::abs(normal), {0, 0, 1});
}

TEST_F(SmallScene, AddedLightShinesWhereItWasToldTo) {
  LightView l;
  l.type = LightType::Directional;
  l.direction = glm::normalize(vec3(1, -2, 0.5f));
  l.intensity = vec3(3, 2, 1);
  addLight(scene, l, "sun");
  EXPECT_TRUE(findByName(scene, "sun"));
  EXPECT_FALSE(findByName(scene, "moon"));
  const SceneView view = extract();
  ASSERT_EQ(view.lights.size(), 2u);
  expectNear(view.lights[1].direction, l.direction);
  expectNear(view.lights[1].intensity, l.intensity);
}

} // namespace lambent::test::scene_test
