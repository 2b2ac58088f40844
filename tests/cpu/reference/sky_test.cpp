// The reference under a sky that is not constant, against fine sums over directions.
#include "engine/trace/analytic_query.h"
#include "engine/trace/embree_query.h"
#include "gi/lighting/receivers.h"
#include "gi/reference/path_tracer.h"
#include "gi/reference/state_file.h"
#include "tests/support/daylight.h"
#include "tests/support/hand_scene.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace lambent {
namespace {

using test::directionAt;

/// Camera whose pixels all see about the same point, the origin, of a plate with unit normal `n`.
CameraView probe(const vec3& n) {
  CameraView camera;
  const vec3 back = glm::normalize(n + 0.3f * vec3(n.y, n.z, n.x));
  const vec3 right = glm::normalize(glm::cross(std::abs(back.y) < 0.9f ? vec3(0, 1, 0) : vec3(0, 0, 1), back));
  camera.worldFromView = mat4(mat3(right, glm::cross(back, right), back));
  camera.worldFromView[3] = vec4(2.0f * back, 1);
  camera.near = 1e-3f;
  camera.fovY = 1e-4f;
  camera.width = camera.height = 32;
  return camera;
}

ReferencePicture trace(const ReferenceInputs& in, uint32_t samples, ReferenceBuffer buffer) {
  ReferenceSums sums(in.camera.width, in.camera.height);
  RayCounts counts;
  addSamples(sums, in, samples, counts);
  return readReference(sums, in, buffer);
}

test::Mean meanOf(const Image& image) {
  std::vector<double> values;
  for (const vec3& p : image.pixels) values.push_back(double(luminance(p)));
  return test::meanOf(values);
}

TEST(SkyReference, OpenPlates) {
  for (const float elevation : {3.0f, 30.0f, 75.0f})
    for (const vec3& n : {vec3(0, 1, 0), vec3(0, -1, 0), glm::normalize(vec3(1, 0.5f, 0.2f))}) {
      AnalyticQuery plane;
      plane.addPlane({0, 0, 0}, n, {vec3(0.6f)});
      LightSet lights;
      lights.sky = Sky::daylight(directionAt(elevation, 65), 3);
      const CameraView camera = probe(n);
      const double wanted = 0.6 / std::acos(-1.0) * double(luminance(vec3(test::openIrradiance(lights.sky, n))));
      const test::Mean m = meanOf(trace({plane, lights, camera, 0}, 64, ReferenceBuffer::Direct).mean);
      EXPECT_LT(std::abs(m.mean - wanted), test::kDeviateLimit * m.error + 1e-4 * wanted) << elevation << ' ' << n.y;
      EXPECT_LT(m.error, 3e-3 * wanted);
    }
}

TEST(SkyReference, OneBounceBetweenTwoPlates) {
  // A long wall on a floor: what the wall, itself lit by the sky alone, sends to a point of the floor. By a fine sum
  // over the wall, whose direct light is a sum over the half of its hemisphere that is above the floor.
  test::HandScene scene;
  const uint32_t grey = scene.material(vec3(0.5f));
  scene.quad({-1000, 0, -1000}, {0, 0, 2000}, {2000, 0, 0}, grey); // floor
  scene.quad({-1, 0, -1000}, {0, 1000, 0}, {0, 0, 2000}, grey);    // wall, seen from +x
  const SceneView view = scene.view();
  EmbreeQuery rays(scene.assets);
  rays.update(view);
  LightSet lights;
  lights.sky = Sky::daylight(directionAt(20, 90), 3);
  // Every point of a wall without end sees the same sky. Its form factor from the floor is a half of 1 − cos of the
  // angle over which the wall is seen: all of a quarter sphere, cosine-weighted ½.
  const double wall = test::overSphere(512, [&](const vec3& d) {
    return d.y > 0 ? double(luminance(lights.sky.radiance(d))) * std::max(0.0, double(d.x)) : 0.0;
  });
  const double wanted = 0.5 * wall * 0.5 * 0.5 / std::acos(-1.0); // E_floor = ρ E_wall / 2, and it reflects ρ/π of that
  const CameraView camera = probe({0, 1, 0});
  const test::Mean m = meanOf(trace({rays, lights, camera, 1}, 256, ReferenceBuffer::Indirect).mean);
  EXPECT_LT(std::abs(m.mean - wanted), test::kDeviateLimit * m.error + 3e-3 * wanted) << m.mean << " for " << wanted;
  EXPECT_LT(m.error, 5e-3 * wanted);
}

TEST(SkyReference, GlossyPlate) {
  for (const float metalness : {0.0f, 1.0f}) {
    test::HandScene scene;
    const uint32_t m = scene.material({0.8f, 0.6f, 0.3f});
    scene.assets.materials[m].roughness = 0.4f;
    scene.assets.materials[m].metalness = metalness;
    const vec3 n(0, 1, 0);
    scene.quad({-10, 0, -10}, {0, 0, 20}, {20, 0, 0}, m);
    scene.sky = Sky::daylight(directionAt(12, 160), 3);
    scene.camera = probe(n);
    const SceneView view = scene.view();
    EmbreeQuery rays(scene.assets);
    rays.update(view);
    const LightSet lights = collectLights(view);
    const Receiver receiver =
        makeReceiver(n, glm::normalize(scene.camera.position()), {0.8f, 0.6f, 0.3f}, 0.4f, metalness);
    const double wanted = test::overSphere(512, [&](const vec3& d) {
      if (d.y <= 0) return 0.0;
      return double(luminance(reflectanceOf(receiver, d) * lights.sky.radiance(d)) * d.y);
    });
    const ReferenceInputs in{rays, lights, view.camera, 0, 0, 1, &view};
    const test::Mean mean = meanOf(trace(in, 128, ReferenceBuffer::Direct).mean);
    EXPECT_LT(std::abs(mean.mean - wanted), test::kDeviateLimit * mean.error + 1e-3 * wanted) << metalness;
    EXPECT_LT(mean.error, 5e-3 * wanted);
  }
}

TEST(SkyReference, BackgroundAndKey) {
  test::HandScene scene;
  scene.quad({-1, -1, -100}, {2, 0, 0}, {0, 2, 0}, scene.material(vec3(0.5f)));
  scene.sky = Sky::daylight(directionAt(30, 170), 3);
  scene.camera.width = 24;
  scene.camera.height = 16;
  SceneView view = scene.view();
  EmbreeQuery rays(scene.assets);
  rays.update(view);
  LightSet lights = collectLights(view);
  const ReferenceInputs in{rays, lights, view.camera, 1};
  const ReferencePicture p = trace(in, 1, ReferenceBuffer::Beauty);
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(23, 3), std::pair(5, 15)}) {
    const vec3 d = cameraRay(view.camera, (float(x) + 0.5f) / 24, (float(y) + 0.5f) / 16).direction;
    EXPECT_EQ(p.mean.at(x, y), scene.sky.radiance(d));
  }
  const uint64_t key = referenceKey(view, in);
  view.sky = Sky::daylight(directionAt(31, 170), 3);
  EXPECT_NE(referenceKey(view, in), key);
  view.sky = Sky::daylight(directionAt(30, 170), 3);
  EXPECT_EQ(referenceKey(view, in), key);
}

} // namespace
} // namespace lambent
