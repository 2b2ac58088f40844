// Poisson samples over surfaces: evenly spread, on both sides, riding on their objects.
#include "engine/trace/embree_query.h"
#include "gi/vpl/sources.h"
#include "tests/support/hand_scene.h"
#include "tests/support/spread_lights.h"

namespace lambent::test::surface_samples_test {

class SurfaceSamplesTest : public ::testing::Test {
 protected:
  SurfaceSamplesTest() {
    const uint32_t white = scene.material(vec3(0.6f)), black = scene.material(vec3(0));
    scene.quad(vec3(-2, 0, -2), vec3(0, 0, 4), vec3(4, 0, 0), white); // 16 m², front up
    scene.box(vec3(0, 1, 0), vec3(1, 2, 1), white, false);            // 6 m²
    scene.quad(vec3(-2, 3, -2), vec3(0, 0, 1), vec3(1, 0, 0), black);
    scene.lamp({-1, 2.5f, 0.3f}, vec3(3));
  }
  VplChanges update(const SceneChanges& changes = {}) {
    const SceneView view = scene.view(changes);
    if (!rays) rays = std::make_unique<EmbreeQuery>(scene.assets);
    rays->update(view, true);
    log = {};
    return placeVpls(VplSource::Poisson, set, {view, *rays, collectLights(view), settings}, log);
  }

  HandScene scene;
  std::unique_ptr<EmbreeQuery> rays;
  SmcSettings settings{.vpls = 1000, .paths = 4};
  VplSet set;
  VplUpdateLog log;
};

TEST_F(SurfaceSamplesTest, StandEvenlyOnBothSides) {
  update();
  double areas[3] = {}; // of the floor, up and down, and of the box
  int up = 0, down = 0, box = 0;
  float nearest = kInfinity;
  for (size_t i = 0; i < set.slots.size(); ++i) {
    const Vpl& v = set.slots[i];
    ASSERT_TRUE(v.alive);
    areas[v.position.y > 0.5f ? 2 : v.normal.y > 0 ? 0 : 1] += v.area;
    EXPECT_NE(v.position.y, 3) << "black";
    if (v.position.y < 0.5f)
      (v.normal.y > 0 ? up : down) += 1;
    else
      ++box;
    for (size_t j = 0; j < i; ++j)
      if (glm::dot(v.normal, set.slots[j].normal) > 0)
        nearest = std::min(nearest, glm::distance(v.position, set.slots[j].position));
  }
  // About in proportion to area; what they stand for is.
  EXPECT_NEAR(up, 1000 * 16 / 44.0, 40);
  EXPECT_NEAR(down, 1000 * 16 / 44.0, 40);
  EXPECT_NEAR(box, 1000 * 12 / 44.0, 40);
  EXPECT_NEAR(areas[0], 16, 0.4);
  EXPECT_NEAR(areas[1], 16, 0.4);
  EXPECT_NEAR(areas[2], 12, 0.4);
  // Of the densest packing 0.225 m lie between neighbours; of independent points the nearest two are millimetres apart.
  EXPECT_GT(nearest, 0.09f);
}

/// Where walls meet, each stands for its own wall.
TEST_F(SurfaceSamplesTest, StandForWhatFacesAsTheyDo) {
  scene.box(vec3(-2, 0, -2), vec3(2, 4, 2), scene.material(vec3(0.6f)), true);
  update();
  size_t points = 0;
  for (size_t slot = 0; slot < set.slots.size(); ++slot)
    for (const CellPoint& p : set.cells[slot].points) {
      ++points;
      ASSERT_GT(glm::dot(p.geometricNormal, set.slots[slot].geometricNormal), 0.5f);
    }
  EXPECT_GT(points, 10000u);
}

TEST_F(SurfaceSamplesTest, StayAndRideAndAreLitAnew) {
  update();
  const VplSet first = set;
  double light = 0;
  for (const Vpl& v : first.slots) light += luminance(v.radiance) * v.area;
  EXPECT_GT(light, 0);

  EXPECT_TRUE(update(kCameraChanged).movedSlots.empty()); // the camera's
  EXPECT_EQ(log.paths.traced, 0u);
  for (size_t i = 0; i < set.slots.size(); ++i) {
    EXPECT_EQ(set.slots[i].position, first.slots[i].position);
    EXPECT_EQ(set.slots[i].radiance, first.slots[i].radiance);
  }

  scene.lights[0].intensity *= 2;
  update(kLightsChanged);
  EXPECT_EQ(log.paths.traced, 0u) << "the paths stay, their light is another";
  for (size_t i = 0; i < set.slots.size(); ++i)
    EXPECT_LT(glm::distance(set.slots[i].radiance, 2.0f * first.slots[i].radiance),
              1e-5f + 1e-4f * first.slots[i].radiance.y);
  scene.lights[0].intensity *= 0.5f;
  update(kLightsChanged);

  const vec3 way(0.5f, 0.25f, -0.5f);
  scene.move(1, way, 7);
  const VplChanges moved = update(kGeometryChanged);
  int rode = 0;
  for (size_t i = 0; i < set.slots.size(); ++i) {
    const bool onBox = first.slots[i].position.y > 0.5f;
    rode += onBox;
    EXPECT_LT(glm::distance(set.slots[i].position, first.slots[i].position + (onBox ? way : vec3(0))), 1e-5f);
  }
  EXPECT_EQ(moved.movedSlots.size(), size_t(rode));
  EXPECT_GT(log.relit, 0u);
  EXPECT_LT(log.paths.retraced, 1000u * 4) << "only what touches the box or starts on it";
  // As if lit from scratch.
  std::vector<Vpl> again = set.slots;
  relight(again, *rays, collectLights(scene.view()), settings.paths, settings.bounces, 1, set.cells);
  for (size_t i = 0; i < again.size(); ++i) ASSERT_EQ(again[i].radiance, set.slots[i].radiance) << i;
}

/// An object that comes or goes: the samples are shared out again.
TEST_F(SurfaceSamplesTest, AreSharedOutAgain) {
  update();
  scene.instances.resize(1);
  const VplChanges changes = update(kInstancesChanged);
  EXPECT_EQ(changes.movedSlots.size(), 1000u);
  double area = 0;
  for (const Vpl& v : set.slots) {
    EXPECT_LT(v.position.y, 0.5f);
    area += v.area;
  }
  EXPECT_NEAR(area, 32, 0.1);
}

} // namespace lambent::test::surface_samples_test
