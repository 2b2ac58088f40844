// The reference and virtual lights are two ways to the same number: with exact areas and a ray for every pair, the
// gather must agree with it, clamped alike.
#include "engine/trace/embree_query.h"
#include "gi/reference/path_tracer.h"
#include "gi/vpl/smc.h"
#include "tests/support/hand_scene.h"
#include "tests/support/spread_lights.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lambent {
namespace {

TEST(ReferenceAgainstVpls, ClampedGatherOfEvenlySpreadLights) {
  test::HandScene scene;
  const vec3 size(2, 1, 3), albedo(0.6f, 0.5f, 0.4f);
  scene.box({0, 0, 0}, size, scene.material(albedo), true);
  scene.quad({0.7f, 0.99f, 1}, {0.5f, 0, 0}, {0, 0, 0.5f}, scene.material(vec3(0), vec3(4))); // faces down
  LightView lamp;
  lamp.position = {1.6f, 0.4f, 2.5f};
  scene.lights.push_back(lamp);
  scene.camera.worldFromView[0] = vec4(-1, 0, 0, 0); // looks along +Z
  scene.camera.worldFromView[2] = vec4(0, 0, -1, 0);
  scene.camera.worldFromView[3] = vec4(1, 0.5f, 0.1f, 1);
  scene.camera.width = 24;
  scene.camera.height = 16;
  const SceneView view = scene.view();
  EmbreeQuery rays(scene.assets);
  rays.update(view);
  const LightSet lights = collectLights(view);
  constexpr int kBounces = 3, kPerSet = 2000, kSets = 16;
  constexpr float kClamp = 3; // 1/m²
  GatherSettings gather;
  gather.disk = 0;
  gather.clamp = kClamp;
  RayCounts counts;

  std::vector<double> means;
  for (uint32_t set = 0; set < kSets; ++set) {
    std::vector<Vpl> vpls = test::spreadOverBox(size, albedo, kPerSet, set);
    std::vector<Vpl*> all;
    for (Vpl& v : vpls) all.push_back(&v);
    estimateRadiance(all, rays, lights, 16, kBounces, 1, counts);
    double sum = 0;
    for (const vec3& e : gatherByRays(rays, view.camera, lightsOf(vpls), gather, counts)) sum += double(e.y) / (24 * 16);
    means.push_back(sum);
  }

  ReferenceSums sums(24, 16);
  const ReferenceInputs in{rays, lights, view.camera, kBounces, kClamp, 1};
  addSamples(sums, in, 1000, counts);
  const ReferencePicture picture = readReference(sums, in, ReferenceBuffer::Irradiance);
  double truth = 0;
  for (const vec3& e : picture.mean.pixels) truth += double(e.y) / (24 * 16);
  const test::Mean m = test::meanOf(means);
  EXPECT_LT(std::abs(m.mean - truth), test::kDeviateLimit * std::hypot(m.error, truth * picture.relativeErrorOfMean))
      << m.mean << " against " << truth;
  EXPECT_LT(m.error, 0.01 * truth) << "too noisy to tell";
}

} // namespace
} // namespace lambent
