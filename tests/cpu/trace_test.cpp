#include "engine/core/rng.h"
#include "engine/trace/analytic_query.h"
#include "tests/support/hand_scene.h"

namespace lambent::test::trace_test {

TEST(Trace, EmbreeAgreesWithClosedForms) {
  // A room of quads and a box in it, whose sides seen from without are backs, against the same analytic shapes.
  HandScene scene;
  const uint32_t wall = scene.material(vec3(0.5f)), red = scene.material({0.8f, 0.1f, 0.1f});
  scene.box({-2, -1, -3}, {2, 1, 3}, wall, true);
  scene.box({-0.5f, -1, -0.5f}, {0.5f, 0, 0.5f}, red, false);
  EmbreeQuery embree(scene.assets);
  embree.update(scene.view());
  AnalyticQuery analytic;
  analytic.addBox({-2, -1, -3}, {2, 1, 3}, {vec3(0.5f)});
  analytic.addBox({-0.5f, -1, -0.5f}, {0.5f, 0, 0.5f}, {vec3(0.8f, 0.1f, 0.1f)});
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < 2000; ++i) {
    Rng rng(1, Stream::Test, i);
    rays.push_back({{1.5f, 0.4f, rng.next() * 4 - 2}, sampleSphere(rng.next2()), i % 3 ? kInfinity : 1.2f});
  }
  const auto [a, t, blocked] = Answers(embree, rays);
  const std::vector<SurfaceHit> b = Answers(analytic, rays).hits;
  int hits = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(a[i].valid(), b[i].valid());
    EXPECT_EQ(blocked[i] != 0, a[i].valid());
    EXPECT_EQ(t[i] < kInfinity, a[i].valid());
    if (!a[i].valid()) continue;
    ++hits;
    EXPECT_NEAR(a[i].t, b[i].t, 1e-4f);
    EXPECT_NEAR(t[i], b[i].t, 1e-4f);
    EXPECT_GT(glm::dot(a[i].normal, b[i].normal), 0.999f);
    EXPECT_LT(glm::length(a[i].geometricNormal - b[i].geometricNormal), 1e-3f);
    EXPECT_LT(glm::length(a[i].position - b[i].position), 1e-4f);
    EXPECT_LT(glm::length(a[i].albedo - b[i].albedo), 1e-6f);
  }
  EXPECT_GT(hits, 1000);
}

/// Back to back in one place, mirrored, reshaped and cut out: an eye sees the front behind each back, light meets both.
TEST(Trace, AnEyeLooksThroughHiddenBacks) {
  HandScene scene;
  const uint32_t hidden = scene.material(vec3(0.2f)), shown = scene.material(vec3(0.8f)), holes = scene.lattice();
  scene.assets.materials[hidden].backHidden = scene.assets.materials[holes].backHidden = true;
  const auto facing = [&](float y, float sign, uint32_t material) { // front sign · +y
    return sign > 0 ? scene.quad({-1, y, -1}, {0, 0, 2}, {2, 0, 0}, material)
                    : scene.quad({-1, y, -1}, {2, 0, 0}, {0, 0, 2}, material);
  };
  facing(0, 1, shown);
  facing(1, 1, hidden), facing(1, -1, hidden);
  facing(2, -1, hidden);
  scene.place(facing(3, -1, hidden), glm::scale(mat4(1), vec3(-1, 1, 1)));
  scene.reshape(facing(4, -1, hidden), {{-1, 4, -1}, {1, 4, -1}, {1, 4.5f, 1}, {-1, 4.5f, 1}});
  scene.quad({-1, 5, 1}, {2, 0, 0}, {0, 0, -2}, holes); // cut out where x is below 0
  const TracedScene traced(scene);
  const auto met = [&](float x, float y, float way, bool eye) {
    const Ray ray{{x, y, 0.3f}, {0, way, 0}};
    return eye ? traced.rays.seen(ray) : traced.rays.closest(ray);
  };
  EXPECT_NEAR(met(0.5f, 6, -1, true).t, 1, 1e-5f) << "the front of what is not cut out";
  EXPECT_NEAR(met(-0.5f, 6, -1, true).t, 5, 1e-5f) << "through the hole and four backs, to the front at 1";
  EXPECT_NEAR(met(-0.5f, 6, -1, true).normal.y, 1, 1e-5f);
  EXPECT_NEAR(met(-0.5f, 6, -1, false).t, 6 - 4.325f, 1e-5f) << "light meets backs";
  EXPECT_NEAR(met(-0.5f, 2.5f, 1, true).t, 0.5f, 1e-5f) << "a mirrored front stays one";
  EXPECT_FALSE(met(0.5f, 4.4f, 1, true).valid()) << "a back alone is above";
  EXPECT_NEAR(met(0.5f, -1, 1, true).t, 1, 1e-5f) << "backs that are not hidden are seen";
  EXPECT_NEAR(met(0.5f, 0.5f, 1, true).t, 0.5f, 1e-5f);
  EXPECT_NEAR(met(0.5f, 0.5f, 1, true).normal.y, -1, 1e-5f);
}

TEST(Trace, InstancesWithRotationScaleAndMirror) {
  HandScene scene;
  const uint32_t lamp = scene.material(vec3(0.5f), vec3(3));
  scene.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, lamp); // front +y
  scene.instances[0].worldFromObject = mat4(vec4(2, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, -3, 0), vec4(0, 5, 0, 1));
  EmbreeQuery rays(scene.assets);
  rays.update(scene.view());
  const SurfaceHit above = rays.closest(Ray{{1.9f, 7, -2.9f}, {0, -1, 0}});
  ASSERT_TRUE(above.valid());
  EXPECT_NEAR(above.t, 2, 1e-5);
  EXPECT_NEAR(above.normal.y, 1, 1e-5);
  EXPECT_EQ(above.emission, vec3(3)); // glTF: the front stays the front under mirroring
  const SurfaceHit below = rays.closest(Ray{{1.9f, 3, -2.9f}, {0, 1, 0}});
  ASSERT_TRUE(below.valid());
  EXPECT_NEAR(below.normal.y, -1, 1e-5);
  EXPECT_EQ(below.emission, vec3(0));
  EXPECT_FALSE(rays.closest(Ray{{2.1f, 7, 0}, {0, -1, 0}}).valid());
}

/// Faces of a box are meshes of their own that share corners and nothing else; the box is turned and far from round
/// numbers. Rays at its joints and corners, and at the diagonals of its faces, must meet something.
TEST(Trace, NoRaySlipsThroughTheJointsOfAClosedBox) {
  HandScene scene;
  scene.box(vec3(-1.37f, -0.71f, -2.13f), vec3(1.91f, 1.13f, 0.77f), scene.material(vec3(0.5f)), true);
  const mat4 turned =
      glm::rotate(glm::rotate(glm::translate(mat4(1), vec3(31.7f, -12.3f, 7.9f)), 0.83f, vec3(0.2f, 1, 0.1f)), 0.31f,
                  vec3(1, 0, 0.3f));
  scene.turn(turned);
  EmbreeQuery query(scene.assets);
  query.update(scene.view(), true);
  Rng rng(5, Stream::Test, 0);
  std::vector<Ray> rays;
  for (const Mesh& mesh : scene.assets.meshes)
    for (int edge = 0; edge < 5; ++edge) // the sides and a diagonal
      for (int k = 0; k < 4000; ++k) {
        const vec3 a = mesh.positions[size_t(edge % 4)], b = mesh.positions[size_t(edge == 4 ? 2 : (edge + 1) % 4)];
        const vec3 to = vec3(turned * vec4(a + (b - a) * rng.next(), 1));
        const vec3 from = vec3(turned * vec4(vec3(-1, -0.5f, -1.8f) + rng.next3() * vec3(2.5f, 1.4f, 2.3f), 1));
        rays.push_back({from, to - from});
      }
  const Answers met(query, rays);
  EXPECT_TRUE(std::ranges::all_of(met.hits, &SurfaceHit::valid));
  EXPECT_EQ(met.free(), 0);
}

TEST(Trace, MovedInstancesAreFound) {
  HandScene scene;
  scene.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, scene.material(vec3(0.5f)));
  EmbreeQuery rays(scene.assets);
  rays.update(scene.view());
  EXPECT_TRUE(rays.occluded(Ray{{0, 1, 0}, {0, -1, 0}}));
  scene.move(0, {10, 0, 0});
  rays.update(scene.view(kGeometryChanged));
  EXPECT_FALSE(rays.occluded(Ray{{0, 1, 0}, {0, -1, 0}}));
  EXPECT_TRUE(rays.occluded(Ray{{10, 1, 0}, {0, -1, 0}}));
}

TEST(Trace, AlphaMaskLetsRaysThrough) {
  HandScene scene;
  scene.quad({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, scene.lattice());
  EmbreeQuery rays(scene.assets);
  rays.update(scene.view());
  const Ray left{{0.5f, 1, 1}, {0, 0, -1}}, right{{1.5f, 1, 1}, {0, 0, -1}};
  EXPECT_FALSE(rays.closest(left).valid());
  EXPECT_FALSE(rays.occluded(left));
  EXPECT_TRUE(rays.occluded(right));
  EXPECT_NEAR(rays.closest(right).albedo.y, 1, 1e-3);
  const std::vector<float> t = Answers(rays, std::vector{left, right}).distances;
  EXPECT_EQ(t[0], kInfinity);
  EXPECT_NEAR(t[1], 1, 1e-5);
}

TEST(Trace, NotANumberIsAMissAndDoesNotAbort) {
  HandScene scene;
  scene.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, scene.material(vec3(0.5f)));
  EmbreeQuery rays(scene.assets);
  rays.update(scene.view());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Ray> bad{{{nan, 1, 0}, {0, -1, 0}},      {{0, 1, 0}, {0, nan, 0}}, {{0, 1, 0}, {0, -kInfinity, 0}},
                             {{0, 1, 0}, {0, -1, 0}, nan},   {{0, 1, 0}, {0, 0, 0}},   {{0, 1, 0}, {0, -1, 0}, -1},
                             {{kInfinity, 1, 0}, {0, -1, 0}}};
  const auto [hits, t, blocked] = Answers(rays, bad);
  for (size_t i = 0; i < bad.size(); ++i) {
    EXPECT_FALSE(hits[i].valid()) << i;
    EXPECT_FALSE(blocked[i]) << i;
    EXPECT_EQ(t[i], kInfinity) << i;
  }
}

/// Debian's Embree ends the program where a packet's ray is not a number in an instance's space, or too far away there.
TEST(Trace, InstancesWithoutSizeAreMetByNoRay) {
  HandScene scene;
  const uint32_t white = scene.material(vec3(0.5f));
  scene.box(vec3(-1), vec3(1), white, true);
  for (const vec3& scale : {vec3(0), vec3(1, 0, 1), vec3(1e-17f), vec3(1e-11f, 1, 1), vec3(1e-30f)}) {
    scene.quad({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, white);
    scene.place(uint32_t(scene.instances.size()) - 1, glm::scale(mat4(1), scale));
  }
  EmbreeQuery embree(scene.assets);
  embree.update(scene.view());
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < 64; ++i) {
    Rng rng(1, Stream::Test, i);
    rays.push_back({vec3(0.3f, 0.2f, 0.7f), sampleSphere(rng.next2())});
    rays.push_back({vec3(3e9f, 0.2f, 0.7f), {-1, 0, 0}}); // too far for the thinnest
  }
  const auto [hits, t, blocked] = Answers(embree, rays);
  for (size_t i = 0; i < rays.size(); i += 2) {
    ASSERT_TRUE(hits[i].valid() && blocked[i] && t[i] < kInfinity);
    EXPECT_LT(hits[i].instance, 6u);
  }
}

TEST(Trace, EmptyScene) {
  SceneAssets none;
  EmbreeQuery rays(none);
  rays.update(SceneView{});
  EXPECT_FALSE(rays.closest(Ray{{0, 1, 0}, {0, -1, 0}}).valid());
}

} // namespace lambent::test::trace_test
