#include "engine/gpu_trace/gpu_rays.h"

#include "tests/gl/gl_fixture.h"
#include "tests/support/random_world.h"

namespace lambent::test::gpu_rays_test {

class GpuRaysTest : public GlTest {};

std::vector<Ray> raysIn(const Aabb& box, size_t count, uint32_t seed) {
  std::vector<Ray> rays(count);
  for (size_t i = 0; i < count; ++i) {
    Rng rng(seed, Stream::Test, uint32_t(i));
    const vec3 origin = box.lo + box.size() * rng.next3();
    rays[i] = i % 2 ? Ray{origin, sampleSphere(rng.next2())}
                    : segment(origin, box.lo + box.size() * rng.next3()); // both ends anywhere
  }
  return rays;
}

/// Rays of which the two say different things: something or nothing, or places that lie apart by more than both grains.
int differences(const RayQuery& a, const RayQuery& b, std::span<const Ray> rays) {
  const Answers byA(a, rays), byB(b, rays);
  int count = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const SurfaceHit &x = byA.hits[i], &y = byB.hits[i];
    EXPECT_EQ(byB.distances[i], y.t);
    EXPECT_EQ(byB.blocked[i] != 0, y.valid());
    const auto apart = [&](float t) { return std::abs((x.t - t) * glm::dot(x.geometricNormal, rays[i].direction)); };
    if (x.valid() != y.valid() || (x.valid() && apart(y.t) > 2 * a.rayEpsilon())) {
      ++count;
      continue;
    }
    if (!x.valid() || x.instance != y.instance || x.triangle != y.triangle) continue;
    EXPECT_EQ(x.primitive, y.primitive);
    EXPECT_LT(glm::distance(x.normal, y.normal), 1e-3f);
    EXPECT_LT(glm::distance(x.geometricNormal, y.geometricNormal), 1e-4f);
    EXPECT_LT(glm::distance(x.albedo, y.albedo) + glm::distance(x.emission, y.emission), 1e-3f);
  }
  return count;
}

TEST_F(GpuRaysTest, AgreeWithEmbreeWhileAnythingHappens) {
  RandomWorld world(0.01f);
  GpuRays gpu(programs, world.assets());
  int wrong = 0, all = 0;
  for (uint32_t frame = 0; frame < 24; ++frame) {
    const SceneView& view = world.step(frame == 0 ? 60 : int(frame % 4));
    gpu.update(view);
    const std::vector<Ray> rays = raysIn(view.boundsWorld, 2000, frame);
    wrong += differences(world.rays(), gpu, rays);
    all += int(rays.size());
  }
  EXPECT_EQ(gpu.rayEpsilon(), world.rays().rayEpsilon());
  EXPECT_LE(wrong, 2) << "of " << all; // at edges
}

TEST_F(GpuRaysTest, MasksAreCutOutAsEmbreeDoes) {
  for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
    for (const bool nearest : {false, true}) {
      HandScene scene;
      std::vector<u8vec4> texels;
      for (int i = 0; i < 15; ++i) texels.push_back({255, 255, 255, uint8_t(i * 977 % 256)});
      const uint32_t material = scene.material(vec3(0.5f));
      Material& m = scene.assets.materials[material];
      m.alphaMode = AlphaMode::Mask;
      m.alphaCutoff = 0.45f;
      m.alpha = 0.9f;
      m.baseColorTexture = scene.texture(5, texels);
      m.baseColorTexture.wrapU = wrap;
      m.baseColorTexture.wrapV = Wrap::Repeat;
      m.baseColorTexture.nearest = nearest;
      m.baseColorTexture.uvTransform = mat3(vec3(2.3f, 0.4f, 0), vec3(-0.3f, 3.1f, 0), vec3(-0.7f, 0.2f, 1));
      scene.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, material);
      EmbreeQuery embree(scene.assets);
      embree.update(scene.view());
      GpuRays gpu(programs, scene.assets);
      gpu.update(scene.view());
      std::vector<Ray> rays;
      for (uint32_t i = 0; i < 4000; ++i) {
        Rng rng(5, Stream::Test, i);
        rays.push_back({{2 * rng.next() - 1, 1, 2 * rng.next() - 1}, {0, -1, 0}});
      }
      EXPECT_LE(differences(embree, gpu, rays), 2);
      const auto through = Answers(embree, rays).free();
      EXPECT_GT(through, 500);
      EXPECT_LT(through, 3500);
      embree.setAlphaTest(AlphaTest::None);
      gpu.setAlphaTest(AlphaTest::None);
      EXPECT_EQ(differences(embree, gpu, rays), 0);
      EXPECT_EQ(Answers(gpu, rays).free(), 0);
    }
  }
}

/// A sphere of triangles around the origin.
uint32_t ball(HandScene& scene, uint32_t material, int rings) {
  Mesh mesh;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      const float a = kPi * float(i) / float(rings), b = kPi * float(j) / float(rings);
      mesh.positions.push_back({std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)});
    }
  mesh.normals = mesh.positions;
  const auto at = [&](int i, int j) { return uint32_t(i * 2 * rings + j % (2 * rings)); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  mesh.boundsObject = {vec3(-1), vec3(1)};
  mesh.primitives.push_back({0, uint32_t(mesh.triangles.size()), material, mesh.boundsObject});
  return scene.add(std::move(mesh));
}

TEST_F(GpuRaysTest, NothingSlipsThroughJoints) {
  HandScene scene;
  ball(scene, scene.material(vec3(0.5f)), 24);
  GpuRays gpu(programs, scene.assets);
  gpu.update(scene.view());
  std::vector<Ray> rays;
  const Mesh& mesh = scene.assets.meshes[0];
  for (uint32_t i = 0; i < 30000; ++i) { // at corners, and along edges
    Rng rng(3, Stream::Test, i);
    const uvec3& t = mesh.triangles[rng.below(uint32_t(mesh.triangles.size()))];
    const vec3 origin = 0.6f * (2.0f * rng.next3() - 1.0f) / std::sqrt(3.0f);
    const vec3 at = glm::mix(mesh.positions[t.x], mesh.positions[t.y], i % 3 == 0 ? 0.0f : rng.next());
    rays.push_back({origin, at - origin});
  }
  EXPECT_EQ(Answers(gpu, rays).free(), 0);
}

TEST_F(GpuRaysTest, RaysAlongAxesAndThatAreNone) {
  HandScene scene;
  scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
  GpuRays gpu(programs, scene.assets);
  gpu.update(scene.view());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Ray> rays;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      vec3 d(0);
      d[axis] = side;
      rays.push_back({vec3(0.3f, -0.2f, 0.1f), d});
    }
  rays.push_back({vec3(nan), vec3(0, 0, 1)});
  rays.push_back({vec3(0), vec3(nan, 0, 1)});
  rays.push_back({vec3(0), vec3(0, 0, 1), nan});
  rays.push_back({vec3(0), vec3(0, 0, 1), -1});
  rays.push_back({vec3(0), vec3(0)});
  rays.push_back({vec3(0), vec3(0, 0, 1), 0.999f}); // ends before the wall
  const std::vector<SurfaceHit> hits = Answers(gpu, rays).hits;
  for (size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(hits[i].valid(), i < 6) << i;
  EXPECT_FLOAT_EQ(hits[0].t, 1.3f);
  gpu.closest(std::span<const Ray>(), std::span<SurfaceHit>()); // none is fine
}

TEST_F(GpuRaysTest, AnEmptySceneStopsNothing) {
  HandScene scene;
  scene.material(vec3(0.5f));
  GpuRays gpu(programs, scene.assets);
  gpu.update(scene.view());
  EXPECT_FALSE(gpu.occluded(Ray{vec3(0), vec3(0, 1, 0)}));
}

} // namespace lambent::test::gpu_rays_test
