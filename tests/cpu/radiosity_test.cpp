// Closed forms of the VPL radiance estimate.

#include "tests/support/comparator_world.h"

namespace lambent::test::radiosity_test {

AnalyticQuery floorPlane() {
  AnalyticQuery plane;
  plane.addPlane({0, 0, 0}, {0, 1, 0}, {});
  return plane;
}
const AnalyticQuery plane = floorPlane();

TEST(Radiosity, PointSpotAndSunOnAPlane) {
  const vec3 at(1, 0, -0.5f);
  const float albedo = 0.6f;
  LightSet lights;
  LightView l;
  l.intensity = {10, 20, 30};

  l.type = LightType::Point;
  l.position = {0, 2, 0};
  lights.punctual = {l};
  const vec3 d = l.position - at;
  const vec3 expectedPoint = l.intensity * (d.y / std::pow(glm::length(d), 3.0f)) * albedo / kPi;
  for (int bounces : {1, 3}) { // a lone plane has no second bounce
    const vec3 r = radianceOf(vplAt(at, {0, 1, 0}, 1, albedo), plane, lights, bounces);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(r[c], expectedPoint[c], 1e-3f * expectedPoint[c]);
  }

  // Spot: halfway between the cones in cosine, glTF's falloff is (1/2)² of the point light.
  l.type = LightType::Spot;
  l.direction = {0, -1, 0};
  const float cosine = d.y / glm::length(d);
  l.innerConeCos = cosine + 0.05f;
  l.outerConeCos = cosine - 0.05f;
  lights.punctual = {l};
  vec3 r = radianceOf(vplAt(at, {0, 1, 0}, 1, albedo), plane, lights, 1);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(r[c], 0.25f * expectedPoint[c], 1e-3f * 0.25f * expectedPoint[c]);

  // Range window (KHR_lights_punctual): 1 − (r/range)⁴.
  l.type = LightType::Point;
  l.range = 4;
  lights.punctual = {l};
  const float q = std::pow(glm::length(d) / 4, 4.0f);
  r = radianceOf(vplAt(at, {0, 1, 0}, 1, albedo), plane, lights, 1);
  EXPECT_NEAR(r.x, (1 - q) * expectedPoint.x, 1e-3f * expectedPoint.x);

  l.type = LightType::Directional;
  l.direction = glm::normalize(vec3(1, -2, 0.5f));
  lights.punctual = {l};
  r = radianceOf(vplAt(at, {0, 1, 0}, 1, albedo), plane, lights, 1);
  EXPECT_NEAR(r.y, 20 * -l.direction.y * albedo / kPi, 1e-3f * r.y);
  EXPECT_EQ(radianceOf(vplAt(at, {0, -1, 0}, 1, albedo), plane, lights, 1), vec3(0)); // from below
}

TEST(Radiosity, LightsAddUp) {
  LightSet all;
  vec3 sum(0);
  for (int i = 0; i < 5; ++i) {
    LightView l;
    l.position = {float(i) - 2, 1 + 0.3f * float(i), 0.4f};
    l.intensity = vec3(1 + i, 2, 1);
    LightSet one;
    one.punctual = {l};
    sum += radianceOf(vplAt({0, 0, 0}, {0, 1, 0}, 1, 0.5f), plane, one, 1);
    all.punctual.push_back(l);
  }
  // One light is chosen per path: exact in luminance up to the strata's share, so many paths and a loose bound in
  // colour.
  const vec3 r = radianceOf(vplAt({0, 0, 0}, {0, 1, 0}, 1, 0.5f), plane, all, 1, 4096);
  EXPECT_NEAR(luminance(r), luminance(sum), 1e-3f * luminance(sum));
  EXPECT_NEAR(r.x, sum.x, 0.02f * sum.x);
}

TEST(Radiosity, EmissiveQuadMatchesTheFormFactor) {
  // Quad of a×b at height c with a corner above the point: F = 1/2π (A/√(1+A²) atan(B/√(1+A²)) + B/√(1+B²)
  // atan(A/√(1+B²))).
  for (const float c : {1.0f, 0.2f}) {
    HandScene scene;
    const float a = 1.5f, b = 0.8f, A = a / c, B = b / c;
    scene.quad({0, c, 0}, {a, 0, 0}, {0, 0, b}, scene.material(vec3(0), vec3(2, 1, 0.5f))); // faces down
    scene.quad({-5, 0, -5}, {0, 0, 10}, {10, 0, 0}, scene.material(vec3(0.5f)));
    const TracedScene traced(scene);
    const LightSet& lights = traced.lights;
    ASSERT_EQ(lights.emitters.size(), 1u);
    ASSERT_LT(lights.triangles[0].normal.y, -0.9f);
    const double factor = (A / std::sqrt(1 + A * A) * std::atan(B / std::sqrt(1 + A * A)) +
                           B / std::sqrt(1 + B * B) * std::atan(A / std::sqrt(1 + B * B))) /
                          (2 * kPi);
    std::vector<double> values;
    for (uint32_t id = 0; id < 2000; ++id)
      values.push_back(radianceOf(vplAt({0, 0, 0}, {0, 1, 0}, id, 0.5f), traced.rays, lights, 1).x);
    const double expected = 0.5 * 2 * factor;
    // The stated noise of one estimate with 16 paths (gi/vpl/radiosity.cpp).
    EXPECT_TRUE(agrees(meanOf(values), expected, 0.20 * expected / std::sqrt(2000.0), 1e-4 * expected))
        << "height " << c;
  }
}

/// A wall parts a cell and two lamps: each point sees one of them. Points come in order, lights come in order,
/// directions come in order; paths must not take the first of all together.
TEST(Radiosity, PointsOfACellMeetEveryLight) {
  AnalyticQuery rays;
  rays.addPlane({0, 0, 0}, {0, 1, 0}, {});
  rays.addBox({-0.001f, 0, -5}, {0.001f, 5, 5}, {vec3(0)});
  LightSet lights;
  for (const float x : {-1.0f, 1.0f}) lights.punctual.push_back(lampAt({x, 2, 0}, 10));
  VplCell cell;
  double truth = 0;
  for (int i = 0; i < 32; ++i) {
    const vec3 p(0.01f * (float(i) - 15.5f), 0, 0);
    cell.points.push_back({p, {0, 1, 0}, {0, 1, 0}, vec3(0.5f), 0.01f});
    const vec3 d = lights.punctual[i < 16 ? 0 : 1].position - p;
    truth += 10 * d.y / std::pow(glm::length(d), 3.0f) * 0.5 / double(kPi) / 32;
  }
  for (const int paths : {8, 16, 64}) {
    std::vector<double> values;
    for (uint64_t id = 1; id <= 400; ++id) {
      std::vector<Vpl> one{vplAt(vec3(0), {0, 1, 0}, id, 0.5f)};
      relight(one, rays, lights, paths, 1, 1, {&cell, 1});
      values.push_back(one[0].radiance.x);
    }
    EXPECT_NEAR(meanOf(values).mean / truth, 1, 0.03) << paths << " paths";
  }
}

TEST(Radiosity, WhiteFurnaceOfASphere) {
  // Closed, emission 1, albedo ρ: reflected radiance is ρ + ρ² + … + ρ^B exactly, whatever the directions.
  AnalyticQuery sphere;
  sphere.addSphere({0, 0, 0}, 2, {vec3(0.5f), vec3(1), true});
  LightSet lights;
  lights.sky = vec3(1e-30f); // not empty; never met
  double sum = 0;
  for (int bounces = 1; bounces <= 4; ++bounces) {
    sum += std::pow(0.5, bounces);
    EXPECT_NEAR(radianceOf(vplAt({0, -2, 0}, {0, 1, 0}, 1, 0.5f), sphere, lights, bounces).x, sum, 1e-3 * sum);
  }
}

TEST(Radiosity, WhiteFurnaceOfARoomWithSampledEmitters) {
  // The same with emitters that are sampled: next-event estimation and cosine rays must share the light exactly.
  HandScene scene;
  scene.box({0, 0, 0}, {2, 1, 3}, scene.material(vec3(0.5f), vec3(1)), true);
  const TracedScene traced(scene);
  std::vector<double> values;
  for (uint32_t id = 0; id < 1000; ++id)
    values.push_back(radianceOf(vplAt({0.3f, 0, 1.1f}, {0, 1, 0}, id, 0.5f), traced.rays, traced.lights, 3).x);
  EXPECT_TRUE(agrees(meanOf(values), 0.875, 0.01, 1e-4));
}

TEST(Radiosity, SkyOverAConvexBody) {
  AnalyticQuery sphere;
  sphere.addSphere({0, 0, 0}, 1, {vec3(0.7f)});
  LightSet lights;
  lights.sky = vec3(1, 2, 3);
  for (int bounces : {1, 3}) {
    const vec3 r = radianceOf(vplAt({0, 1, 0}, {0, 1, 0}, 1, 0.7f), sphere, lights, bounces);
    EXPECT_NEAR(r.z, 0.7f * 3, 1e-3f * 2.1f);
  }
}

TEST(Radiosity, FollowsTheIdAlone) {
  AnalyticQuery room;
  room.addBox({-1, -1, -1}, {1, 1, 1}, {vec3(0.6f), vec3(0), true});
  LightSet lights;
  lights.punctual.resize(1);
  const auto at = [&](uint64_t id, uint32_t seed) {
    return radianceOf(vplAt({0, -1, 0.2f}, {0, 1, 0}, id, 0.6f), room, lights, 3, 16, seed);
  };
  // Neither what is asked with it nor its place among them counts.
  std::vector<Vpl> batch;
  for (uint64_t i = 0; i < 40; ++i) batch.push_back(vplAt({0, -1, 0.2f}, {0, 1, 0}, i % 13 == 1 ? 5 : 100 + i, 0.6f));
  relight(batch, room, lights, 16, 3, 1);
  for (const int i : {1, 14, 27}) EXPECT_EQ(batch[size_t(i)].radiance, at(5, 1)) << i;
  EXPECT_NE(at(5, 1), at(6, 1));
  EXPECT_NE(at(5, 1), at(5, 2));
}

TEST(Radiosity, NoLightAndLightInAClosedBoxGiveZero) {
  AnalyticQuery room;
  room.addBox({-2, -2, -2}, {2, 2, 2}, {});
  room.addBox({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, {});
  LightSet none, boxed;
  boxed.punctual.resize(1); // at the origin
  EXPECT_EQ(radianceOf(vplAt({0, -2, 0}, {0, 1, 0}, 1, 0.5f), room, none, 3), vec3(0));
  EXPECT_EQ(radianceOf(vplAt({0, -2, 0}, {0, 1, 0}, 1, 0.5f), room, boxed, 3), vec3(0));
}

TEST(Radiosity, LightOnTheSurfaceStaysFinite) {
  LightSet lights;
  lights.punctual.resize(1); // exactly at the VPL
  EXPECT_EQ(radianceOf(vplAt({0, 0, 0}, {0, 1, 0}, 1, 0.5f), plane, lights, 3), vec3(0));
}

} // namespace lambent::test::radiosity_test
