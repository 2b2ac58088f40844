// Views with more of one thing: as much more as was asked for, and the same light.
#include "engine/core/parallel.h"
#include "gi/measure/scaled_view.h"
#include "gi/reference/traced_image.h"
#include "tests/support/hand_scene.h"
#include "tests/support/images.h"

namespace lambent::test::scaled_view_test {

/// A closed room with a rotated block and a bent sheet in it, one mesh each, seen from inside, with a lamp.
class ScaledViewTest : public ::testing::Test {
 protected:
  ScaledViewTest() {
    const uint32_t wall = scene.material({0.7f, 0.6f, 0.5f}), body = scene.material({0.2f, 0.6f, 0.4f}, vec3(0), true);
    scene.box(vec3(-2), vec3(2), wall, true);
    scene.add(block({0.5f, 0.3f, 0.4f}, body), glm::mat4_cast(glm::angleAxis(0.7f, glm::normalize(vec3(1, 2, 3)))));
    Mesh sheet = test::sheet(3, body);
    sheet.positions = waves(sheet, 0.1f, 0.3f);
    sheet.boundsObject = {};
    for (const vec3& p : sheet.positions) sheet.boundsObject.add(p);
    mat4 place(0.5f);
    place[3] = vec4(0.8f, -0.9f, 0.2f, 1);
    scene.add(std::move(sheet), place);
    scene.lamp(vec3(0.4f, 1.3f, 1.1f), vec3(3, 2, 1));
    scene.camera.worldFromView[3] = vec4(0, 0, 1.9f, 1);
    scene.camera.fovY = 1.5f;
    scene.size(16, 12);
  }

  static Image picture(const SceneView& view) {
    Settings settings;
    settings.image.exposure = 1;
    return traceImage(view, settings, {.buffer = ReferenceBuffer::Beauty, .samples = 64}).image.mean;
  }

  /// The same random numbers, so the same paths wherever surfaces are the same: but where a ray meets an edge, which is
  /// not the same rays on all CPUs (0.0106 with AVX2, less with AVX-512).
  static void expectSameImage(const SceneView& a, const SceneView& b) {
    EXPECT_LT(relativeDifference(picture(b), picture(a)), 0.02);
  }

  static double areaOf(const Mesh& mesh) {
    double area = 0;
    for (const uvec3& t : mesh.triangles)
      area += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                           mesh.positions[t.z] - mesh.positions[t.x]));
    return area;
  }

  HandScene scene;
};

TEST_F(ScaledViewTest, TrianglesAreCutInSquareNumbersOnTheSameSurface) {
  const ScaledView three = splitTriangles(scene.assets, 3);
  const SceneView view = three(scene.view());
  EXPECT_EQ(trianglesOf(view), 9 * trianglesOf(scene.view()));
  for (size_t m = 0; m < scene.assets.meshes.size(); ++m) {
    const Mesh &whole = scene.assets.meshes[m], &cut = view.assets->meshes[m];
    EXPECT_NEAR(areaOf(cut), areaOf(whole), 1e-5 * areaOf(whole));
    // Triangle by triangle the same side out, and corners between those of the first one.
    for (size_t t = 0; t < cut.triangles.size(); ++t) {
      const auto normal = [](const Mesh& mesh, const uvec3& v) {
        return glm::normalize(
            glm::cross(mesh.positions[v.y] - mesh.positions[v.x], mesh.positions[v.z] - mesh.positions[v.x]));
      };
      ASSERT_GT(glm::dot(normal(cut, cut.triangles[t]), normal(whole, whole.triangles[t / 9])), 0.999f);
    }
    for (const vec3& n : cut.normals) ASSERT_NEAR(glm::length(n), 1, 1e-5f);
    EXPECT_EQ(cut.uv0.size(), cut.positions.size());
    uint32_t next = 0;
    for (const Primitive& p : cut.primitives) {
      EXPECT_EQ(p.firstTriangle, next);
      next += p.triangleCount;
    }
    EXPECT_EQ(next, cut.triangles.size());
  }
  expectSameImage(scene.view(), view);
}

TEST_F(ScaledViewTest, CutEdgesMeetWithoutGaps) {
  // Of two triangles on both sides of an edge that they list in opposite order, with nothing round about it.
  Mesh mesh;
  mesh.positions = {{0.1f, 0.7f, -0.3f}, {1.3f, -0.37f, 0.9f}, {2.1f, 1.9f, 0.11f}, {-1.7f, 0.23f, 0.31f}};
  mesh.normals.assign(4, vec3(0, 0, 1));
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  mesh.primitives.push_back({0, 2, 0, {}});
  SceneAssets assets;
  assets.materials.emplace_back();
  assets.meshes.push_back(mesh);
  const SceneAssets assetsCut = tessellated(assets, 7);
  const Mesh& cut = assetsCut.meshes[0];
  const auto key = [](const vec3& p) { return std::tuple(p.x, p.y, p.z); };
  std::set<std::tuple<float, float, float>> sides[2];
  for (size_t t = 0; t < cut.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) sides[t / 49].insert(key(cut.positions[cut.triangles[t][c]]));
  size_t shared = 0;
  for (const auto& p : sides[0]) shared += sides[1].count(p);
  EXPECT_EQ(shared, 8u); // the points of the edge, to the bit
}

TEST_F(ScaledViewTest, PiecesHaveTheTrianglesOfTheWhole) {
  const ScaledView parts = splitInstances(scene.assets, 4);
  const SceneView view = parts(scene.view());
  EXPECT_EQ(view.instances.size(), 6 * 2 + 2 * 4u); // a wall has two triangles
  EXPECT_EQ(trianglesOf(view), trianglesOf(scene.view()));
  std::set<uint32_t> ids;
  Aabb all;
  double area = 0, whole = 0;
  for (const Mesh& mesh : scene.assets.meshes) whole += areaOf(mesh);
  for (const InstanceView& i : view.instances) {
    ids.insert(i.id);
    all.add(i.boundsWorld);
    const Mesh& mesh = view.assets->meshes[i.mesh];
    area += areaOf(mesh);
    ASSERT_EQ(mesh.uv0.size(), mesh.positions.size());
    Aabb box;
    for (const vec3& p : mesh.positions) box.add(p);
    EXPECT_EQ(box.lo, mesh.boundsObject.lo);
    EXPECT_EQ(box.hi, mesh.boundsObject.hi);
  }
  EXPECT_EQ(ids.size(), view.instances.size());
  EXPECT_NEAR(area, whole, 1e-4);
  EXPECT_EQ(all.lo, scene.view().boundsWorld.lo);
  expectSameImage(scene.view(), view);
}

TEST_F(ScaledViewTest, PiecesOfAMovedInstanceSayWhereTheyWere) {
  InstanceView& block = scene.instances[6];
  block.worldFromObjectBefore[3] = vec4(5, 0, 0, 1);
  block.moved = true;
  const ScaledView parts = splitInstances(scene.assets, 2);
  ScaledView split = parts;
  const SceneView view = split(scene.view());
  int moved = 0;
  for (const InstanceView& i : view.instances) {
    const Aabb before = transformed(view.assets->meshes[i.mesh].boundsObject, i.worldFromObjectBefore);
    EXPECT_EQ(i.boundsWorldBefore.lo, before.lo);
    EXPECT_EQ(i.boundsWorldBefore.hi, before.hi);
    moved += i.moved && i.boundsWorldBefore.lo.x > 4;
  }
  EXPECT_EQ(moved, 2) << "both halves of the block";
}

TEST_F(ScaledViewTest, LightsShareTheirIntensity) {
  scene.lights.push_back(scene.lights[0]);
  scene.lights.back().position = vec3(-1, 1, 0);
  const ScaledView split = splitLights(5);
  const SceneView view = split(scene.view());
  ASSERT_EQ(view.lights.size(), 10u);
  vec3 sum(0);
  std::set<uint32_t> ids;
  for (const LightView& l : view.lights) sum += l.intensity, ids.insert(l.id);
  EXPECT_NEAR(sum.x, 6, 1e-5f);
  EXPECT_EQ(ids.size(), 10u);
  EXPECT_EQ(view.lights[7].position, scene.lights[1].position);
}

TEST_F(ScaledViewTest, APictureOfAnotherSizeHasItsShape) {
  const SceneView view = resizedImage(1.5f)(scene.view());
  EXPECT_EQ(view.camera.width, 24);
  EXPECT_EQ(view.camera.height, 18);
  EXPECT_EQ(resizedImage(0.01f)(scene.view()).camera.height, 1);
}

} // namespace lambent::test::scaled_view_test
