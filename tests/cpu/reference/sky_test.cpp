// The reference under a sky that is not constant, against fine sums over directions.
#include "engine/trace/analytic_query.h"
#include "gi/lighting/receivers.h"
#include "gi/reference/state_file.h"
#include "tests/support/daylight.h"
#include "tests/support/reference.h"

namespace lambent::test::sky_test {

/// Camera whose pixels all see about the same point, the origin, of a plate with unit normal `n`.
CameraView probe(const vec3& n) { return probeAt(2.0f * glm::normalize(n + 0.3f * vec3(n.y, n.z, n.x)), vec3(0)); }

TEST(SkyReference, OpenPlates) {
  for (const float elevation : {3.0f, 30.0f, 75.0f})
    for (const vec3& n : {vec3(0, 1, 0), vec3(0, -1, 0), glm::normalize(vec3(1, 0.5f, 0.2f))}) {
      AnalyticQuery plane;
      plane.addPlane({0, 0, 0}, n, {vec3(0.6f)});
      LightSet lights;
      lights.sky = Sky::daylight(directionAt(elevation, 65), 3);

      const double wanted = 0.6 / std::acos(-1.0) * double(luminance(vec3(openIrradiance(lights.sky, n))));
      const Mean m = meanOf(trace({plane, lights, probe(n), 0}, 64, ReferenceBuffer::Direct).mean);
      EXPECT_TRUE(agrees(m, wanted, 3e-3 * wanted, 1e-4 * wanted)) << elevation << ' ' << n.y;
    }
}

TEST(SkyReference, OneBounceBetweenTwoPlates) {
  // A long wall on a floor: what the wall, itself lit by the sky alone, sends to a point of the floor. By a fine sum
  // over the wall, whose direct light is a sum over the half of its hemisphere that is above the floor.
  HandScene scene;
  const uint32_t grey = scene.material(vec3(0.5f));
  scene.quad({-1000, 0, -1000}, {0, 0, 2000}, {2000, 0, 0}, grey); // floor
  scene.quad({-1, 0, -1000}, {0, 1000, 0}, {0, 0, 2000}, grey);    // wall, seen from +x
  scene.sky = Sky::daylight(directionAt(20, 90), 3);
  const TracedScene s(scene);
  // Every point of a wall without end sees the same sky. Its form factor from the floor is a half of 1 − cos of the
  // angle over which the wall is seen: all of a quarter sphere, cosine-weighted ½.
  const double wall = overSphere(512, [&](const vec3& d) {
    return d.y > 0 ? double(luminance(scene.sky.radiance(d))) * std::max(0.0, double(d.x)) : 0.0;
  });
  const double wanted = 0.5 * wall * 0.5 * 0.5 / std::acos(-1.0); // E_floor = ρ E_wall / 2, and it reflects ρ/π of that
  const Mean m = meanOf(trace({s.rays, s.lights, probe({0, 1, 0}), 1}, 256, ReferenceBuffer::Indirect).mean);
  EXPECT_TRUE(agrees(m, wanted, 5e-3 * wanted, 3e-3 * wanted));
}

TEST(SkyReference, GlossyPlate) {
  for (const float metalness : {0.0f, 1.0f}) {
    HandScene scene;
    const vec3 n(0, 1, 0);
    scene.quad({-10, 0, -10}, {0, 0, 20}, {20, 0, 0}, scene.glossyMaterial({0.8f, 0.6f, 0.3f}, 0.4f, metalness));
    scene.sky = Sky::daylight(directionAt(12, 160), 3);
    scene.camera = probe(n);
    const TracedScene s(scene);
    const Receiver receiver =
        makeReceiver(n, glm::normalize(scene.camera.position()), {0.8f, 0.6f, 0.3f}, plainFinish(0.4f, metalness));
    const double wanted = overSphere(512, [&](const vec3& d) {
      if (d.y <= 0) return 0.0;
      return double(luminance(reflectanceOf(receiver, d) * scene.sky.radiance(d)) * d.y);
    });
    const ReferenceInputs in{s.rays, s.lights, scene.camera, 0, 0, 1, &s.view};
    const Mean mean = meanOf(trace(in, 128, ReferenceBuffer::Direct).mean);
    EXPECT_TRUE(agrees(mean, wanted, 5e-3 * wanted, 1e-3 * wanted)) << metalness;
  }
}

TEST(SkyReference, BackgroundAndKey) {
  HandScene scene;
  scene.quad({-1, -1, -100}, {2, 0, 0}, {0, 2, 0}, scene.material(vec3(0.5f)));
  scene.sky = Sky::daylight(directionAt(30, 170), 3);
  scene.size(24, 16);
  TracedScene s(scene);
  SceneView& view = s.view;
  const ReferenceInputs in{s.rays, s.lights, view.camera, 1};
  const ReferenceImage p = trace(in, 1, ReferenceBuffer::Beauty);
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(23, 3), std::pair(5, 15)}) {
    const vec3 d = pixelRay(view.camera, x, y).direction;
    EXPECT_EQ(p.mean.at(x, y), scene.sky.radiance(d));
  }
  const uint64_t key = referenceKey(view, in);
  view.sky = Sky::daylight(directionAt(31, 170), 3);
  EXPECT_NE(referenceKey(view, in), key);
  view.sky = Sky::daylight(directionAt(30, 170), 3);
  EXPECT_EQ(referenceKey(view, in), key);
}

} // namespace lambent::test::sky_test
