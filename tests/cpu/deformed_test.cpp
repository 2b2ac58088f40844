// Deformed instances as rays, emitters and riders see them.
#include "engine/core/rng.h"
#include "engine/view/surface_point.h"
#include "tests/support/hand_scene.h"

#include <glm/gtc/matrix_transform.hpp>

namespace lambent::test::deformed_test {

/// Rays from above the sheet, slanted, most of which meet it.
std::vector<Ray> raysAtSheet(uint32_t count, uint32_t seed) {
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < count; ++i) {
    Rng rng(seed, Stream::Test, i);
    const vec3 origin(rng.next() * 4 - 2, rng.next() * 4 - 2, i % 2 ? 3.0f : -3.0f);
    const vec3 target(rng.next() * 2 - 1, rng.next() * 2 - 1, 0);
    rays.push_back({origin, target - origin});
  }
  return rays;
}

/// A waved sheet beside a flat one, both instances of one mesh, turned and scaled.
struct Sheets {
  HandScene scene;
  mat4 turned = glm::rotate(glm::scale(mat4(1), vec3(0.8f, -0.9f, 0.7f)), 0.4f, glm::normalize(vec3(1, 2, 3)));

  Sheets() {
    scene.add(sheet(24, scene.material({0.8f, 0.4f, 0.2f}, vec3(2))), turned);
    scene.instance(0, glm::translate(mat4(1), vec3(0, 0, -1)));
  }
  const Mesh& mesh() const { return scene.assets.meshes[0]; }
  /// The flat sheet's vertices elsewhere.
  std::vector<vec3> shifted(const vec3& by) const {
    std::vector<vec3> positions = mesh().positions;
    for (vec3& p : positions) p += by;
    return positions;
  }
};

TEST(DeformedRays, MeetWhatAMeshOfTheSameVerticesShows) {
  Sheets sheets;
  sheets.scene.reshape(0, waves(sheets.mesh(), 0.3f, 1));
  EmbreeQuery query(sheets.scene.assets);
  query.update(sheets.scene.view());

  HandScene baked; // the same shape as a rigid mesh, and the same flat neighbour
  baked.assets = sheets.scene.assets;
  Mesh& mesh = baked.assets.meshes.emplace_back(sheets.mesh());
  mesh.positions = sheets.scene.instances[0].deformed->positions;
  mesh.normals = sheets.scene.instances[0].deformed->normals;
  mesh.boundsObject = sheets.scene.instances[0].deformed->boundsObject;
  baked.instance(1, sheets.turned);
  baked.instance(0, sheets.scene.instances[1].worldFromObject);
  EmbreeQuery rigid(baked.assets);
  rigid.update(baked.view());

  const std::vector<Ray> rays = raysAtSheet(3000, 1);
  const auto [hits, distances, blocked] = Answers(query, rays);
  const std::vector<SurfaceHit> wanted = Answers(rigid, rays).hits;
  int onWaves = 0, differing = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(blocked[i] != 0, hits[i].valid() && hits[i].t < rays[i].tMax);
    EXPECT_EQ(distances[i] < kInfinity, hits[i].valid());
    if (hits[i].valid() != wanted[i].valid() || hits[i].triangle != wanted[i].triangle) {
      ++differing; // through an edge
      continue;
    }
    if (!hits[i].valid()) continue;
    onWaves += hits[i].instance == 0;
    EXPECT_EQ(hits[i].instance, wanted[i].instance);
    EXPECT_NEAR(hits[i].t, wanted[i].t, 1e-5f);
    EXPECT_LT(glm::length(hits[i].position - wanted[i].position), 1e-4f);
    EXPECT_LT(glm::length(hits[i].normal - wanted[i].normal), 1e-4f);
    EXPECT_LT(glm::length(hits[i].geometricNormal - wanted[i].geometricNormal), 1e-4f);
    EXPECT_EQ(hits[i].albedo, wanted[i].albedo);
    EXPECT_EQ(hits[i].emission, wanted[i].emission);
  }
  EXPECT_GT(onWaves, 1000);
  EXPECT_LE(differing, 3);
}

TEST(DeformedRays, RefittedForManyFramesHitsAsBuiltAnew) {
  Sheets sheets;
  sheets.scene.reshape(0, waves(sheets.mesh(), 0.1f, 0));
  EmbreeQuery refitted(sheets.scene.assets);
  refitted.update(sheets.scene.view());
  for (uint32_t frame = 1; frame <= 200; ++frame) {
    Rng rng(7, Stream::Test, frame);
    sheets.scene.reshape(0, waves(sheets.mesh(), rng.next(), 6 * rng.next()));
    refitted.update(sheets.scene.view(kGeometryChanged));
    if (frame % 20 != 0) continue;
    EmbreeQuery anew(sheets.scene.assets);
    anew.update(sheets.scene.view());
    const std::vector<Ray> rays = raysAtSheet(500, frame);
    const auto a = Answers(refitted, rays).hits, b = Answers(anew, rays).hits;
    int waved = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(a[i].t, b[i].t) << "frame " << frame << ", ray " << i;
      if (!a[i].valid()) continue;
      waved += a[i].instance == 0;
      ASSERT_EQ(a[i].triangle, b[i].triangle);
      ASSERT_EQ(a[i].normal, b[i].normal);
    }
    EXPECT_GT(waved, 100);
  }
}

TEST(DeformedRays, ComeAndGoWithTheirInstance) {
  Sheets sheets;
  HandScene& scene = sheets.scene;
  scene.instances[0].worldFromObject = mat4(1);
  scene.instances.pop_back();
  EmbreeQuery query(scene.assets);
  const Ray down{{0.01f, 0.02f, 5}, {0, 0, -1}};
  query.update(scene.view());
  EXPECT_NEAR(query.closest(down).t, 5, 1e-5f);
  scene.reshape(0, sheets.shifted({0, 0, 2}));
  query.update(scene.view());
  EXPECT_NEAR(query.closest(down).t, 3, 1e-5f);
  scene.instances[0].deformed = nullptr;
  query.update(scene.view());
  EXPECT_NEAR(query.closest(down).t, 5, 1e-5f);
  scene.instances.clear();
  query.update(scene.view());
  EXPECT_FALSE(query.closest(down).valid());
}

TEST(DeformedRays, RigidInstancesAreBitIdenticalBesideThem) {
  Sheets sheets;
  EmbreeQuery alone(sheets.scene.assets), beside(sheets.scene.assets);
  alone.update(sheets.scene.view());
  sheets.scene.reshape(0, sheets.shifted({0, 0, 50}));
  beside.update(sheets.scene.view());
  const std::vector<Ray> rays = raysAtSheet(1000, 3);
  const auto a = Answers(alone, rays).hits, b = Answers(beside, rays).hits;
  int rigid = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (a[i].instance != 1) continue;
    ++rigid;
    ASSERT_EQ(a[i].t, b[i].t);
    ASSERT_EQ(a[i].normal, b[i].normal);
    ASSERT_EQ(a[i].barycentric, b[i].barycentric);
  }
  EXPECT_GT(rigid, 200);
}

TEST(DeformedRays, MasksStayWithTheirVertices) {
  HandScene scene;
  scene.add(sheet(8, scene.lattice()));
  std::vector<vec3> shifted = scene.assets.meshes[0].positions;
  for (vec3& p : shifted) p.x += 10;
  scene.reshape(0, shifted);
  EmbreeQuery query(scene.assets);
  query.update(scene.view());
  EXPECT_FALSE(query.occluded(Ray{{9.5f, 0.3f, 1}, {0, 0, -1}}));
  EXPECT_TRUE(query.occluded(Ray{{10.5f, 0.3f, 1}, {0, 0, -1}}));
  EXPECT_FALSE(query.occluded(Ray{{0.5f, 0.3f, 1}, {0, 0, -1}})) << "where the bind pose is";
}

TEST(SurfacePoint, IsWhereTheHitWasAlsoAfterTheSurfaceMoved) {
  Sheets sheets;
  HandScene& scene = sheets.scene;
  scene.reshape(0, waves(sheets.mesh(), 0.3f, 1));
  EmbreeQuery query(scene.assets);
  const SceneView view = scene.view();
  query.update(view);
  const std::vector<Ray> rays = raysAtSheet(1000, 5);
  const auto hits = Answers(query, rays).hits;
  int seen[2] = {0, 0};
  for (size_t i = 0; i < rays.size(); ++i) {
    const SurfaceHit& h = hits[i];
    if (!h.valid()) continue;
    ++seen[h.instance];
    const SurfacePoint p = surfacePoint(view, h.instance, h.primitive, h.triangle, h.barycentric);
    EXPECT_LT(glm::length(p.position - h.position), 1e-4f);
    const bool fromFront = glm::dot(p.geometricNormal, rays[i].direction) < 0;
    EXPECT_LT(glm::length(p.geometricNormal * (fromFront ? 1.0f : -1.0f) - h.geometricNormal), 1e-4f);
    EXPECT_EQ(fromFront, h.emission.x > 0) << "the front is where a single-sided emitter shines";
    EXPECT_NEAR(glm::length(p.normal), 1, 1e-4f);
    EXPECT_GT(glm::dot(p.normal, p.geometricNormal), 0.5f);
  }
  EXPECT_GT(seen[0], 100);
  EXPECT_GT(seen[1], 100);

  // Lifted by one along z in object space, a rider moves by the matrix's third column.
  const SurfacePoint before = surfacePoint(view, 0, 0, 17, {0.25f, 0.5f});
  std::vector<vec3> lifted = scene.instances[0].deformed->positions;
  for (vec3& p : lifted) p.z += 1;
  scene.reshape(0, lifted);
  const SurfacePoint after = surfacePoint(scene.view(), 0, 0, 17, {0.25f, 0.5f});
  EXPECT_LT(glm::length(after.position - before.position - vec3(sheets.turned[2])), 1e-4f);
  EXPECT_LT(glm::length(after.geometricNormal - before.geometricNormal), 1e-3f);
}

TEST(DeformedEmitter, ShinesFromItsVertices) {
  Sheets sheets;
  std::vector<vec3> larger = sheets.mesh().positions; // twice as wide, one up: an emitter of twice the area
  for (vec3& p : larger) p = {2 * p.x, p.y, 1};
  sheets.scene.instances[0].worldFromObject = mat4(1);
  sheets.scene.reshape(0, larger);
  const LightSet lights = collectLights(sheets.scene.view());
  ASSERT_EQ(lights.emitters.size(), 2u);
  EXPECT_NEAR(lights.emitters[0].power, 2 * lights.emitters[1].power, 1e-3f);
  EXPECT_NEAR(lights.emitters[0].bounds.centre.z, 1, 1e-5f);
  EXPECT_NEAR(lights.emitters[1].bounds.centre.z, -1, 1e-5f);
}

} // namespace lambent::test::deformed_test
