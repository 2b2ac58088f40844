// Light put into the layered depth cube, and taken out.
#include "gi/lighting/light_set.h"
#include "gi/vpl/sources.h"
#include "tests/support/cube_world.h"
#include "tests/support/effort.h"
#include "tests/support/files.h"
#include "tests/support/random_world.h"

namespace lambent::test::layered_cube_test {

TEST(LayeredCube, ALightOverAFloorBringsWhatItsFormulaSays) {
  CubeWorld w;
  w.scene.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, w.scene.material(vec3(0.5f)));
  w.scene.quad({1, 1, 1}, {0, 0, 0.5f}, {0.5f, 0, 0}, w.scene.material(vec3(0.5f))); // a blocker
  w.lights.push_back(lightAt({2, 2, 2}, {0, -1, 0}, {1, 2, 3}));
  w.gather.disk = 0;
  w.place();
  w.view.boundsWorld.add(vec3(2, 2, 2));
  LayeredCube cube;
  const CubeSettings settings = smallCube();
  const CubeWork work = cube.update(w.inputs(settings));
  EXPECT_EQ(work.lightsIn, 1u);
  size_t lit = 0, dark = 0;
  for (size_t e = 0; e < cube.surfaces().entries().size(); ++e) {
    const CubeEntry& entry = cube.surfaces().entries()[e];
    const vec3 d = vec3(2, 2, 2) - entry.position;
    const float cosine = glm::dot(glm::normalize(d), entry.normal);
    float expected = cosine > 0 ? cosine * glm::normalize(d).y / glm::dot(d, d) : 0;
    // Where the way to the light passes the blocker.
    const vec3 at = entry.position + d * ((1 - entry.position.y) / d.y);
    if (entry.position.y < 0.5f && at.x > 1 && at.x < 1.5f && at.z > 1 && at.z < 1.5f) expected = 0;
    EXPECT_NEAR(cube.irradiance(e).x, expected, 1e-4f);
    EXPECT_NEAR(cube.irradiance(e).z, 3 * expected, 3e-4f);
    (expected > 0 ? lit : dark)++;
  }
  EXPECT_GT(lit, 700u);
  EXPECT_GT(dark, 700u);
}

/// Lights that photons leave in a world.
std::vector<VirtualLight> photonLights(const SceneView& view, const RayQuery& rays, VplSet& set) {
  const SmcSettings settings{.vpls = 96, .bounces = 2};
  const LightSet lights = collectLights(view);
  VplUpdateLog log;
  placeVpls(VplSource::Ir, set, {view, rays, lights, settings, 5}, log);
  return lightsOf(set);
}

/// A random world as it begins, lit by photons.
struct LitWorld {
  RandomWorld world{0.01f};
  const SceneView& view = world.step(0);
  VplSet set;
  std::vector<VirtualLight> lights = photonLights(view, world.rays(), set);
  GatherSettings gather;

  CubeInputs inputs(const CubeSettings& settings) const {
    return {view.boundsWorld, world.rays(), kNothingMoved, false, lights, ~0u, settings, gather};
  }
};

struct CubeKind {
  CubeVisibility sights;
  int levels;
};
class CubeVisibilityTest : public ::testing::TestWithParam<CubeKind> {};

/// After anything happened the cube is the one that is built from what there is now.
TEST_P(CubeVisibilityTest, WhatIsPutInAndTakenOutLeavesNoTrace) {
  RandomWorld world(0.01f);
  CubeSettings settings = smallCube(GetParam().sights, 16);
  settings.levels = GetParam().levels;
  const GatherSettings gather;
  Aabb room;
  room.add(vec3(-4, -1, -4)), room.add(vec3(4, 4, 4));
  LayeredCube kept;
  VplSet set;
  size_t reused = 0, compared = 0;
  for (int frame = 0; frame < (kSanitized ? 3 : GetParam().levels == 0 ? 9 : 6); ++frame) {
    const SceneView& view = world.step(frame % 3 == 2 ? 0 : 2);
    const DirtyRegion moved(view);
    const std::vector<VirtualLight> lights = photonLights(view, world.rays(), set);
    const CubeInputs in{room, world.rays(), frame == 0 ? kNothingMoved : moved, false, lights, 48, settings, gather};
    const CubeWork work = kept.update(in);
    LayeredCube anew;
    anew.update({room, world.rays(), kNothingMoved, true, lights, 48, settings, gather});
    const std::span<const CubeEntry> a = kept.surfaces().entries(), b = anew.surfaces().entries();
    ASSERT_EQ(a.size(), b.size()) << frame;
    ASSERT_EQ(kept.surfaces().cubes().size(), anew.surfaces().cubes().size()) << frame;
    float brightest = 0;
    for (size_t e = 0; e < a.size(); ++e) brightest = std::max(brightest, maxComponent(anew.irradiance(e)));
    ASSERT_GT(brightest, 0);
    for (size_t e = 0; e < a.size(); ++e) {
      ASSERT_EQ(a[e].position, b[e].position) << frame;
      ASSERT_EQ(a[e].neighbours, b[e].neighbours) << frame << ' ' << e;
      ASSERT_LT(maxComponent(glm::abs(kept.irradiance(e) - anew.irradiance(e))), 1e-6f * brightest)
          << frame << ' ' << e;
      ++compared;
    }
    if (frame > 0) reused += work.entriesAnew < a.size();
    if (frame % 3 == 2) {
      EXPECT_EQ(work.entriesAnew, 0u);
    }
  }
  EXPECT_GT(reused, 0u);
  EXPECT_GT(compared, 5000u);
}

INSTANTIATE_TEST_SUITE_P(Sights, CubeVisibilityTest,
                         ::testing::Values(CubeKind{CubeVisibility::Rays, 0}, CubeKind{CubeVisibility::Hemicubes, 0},
                                           CubeKind{CubeVisibility::Rays, 2}, CubeKind{CubeVisibility::Hemicubes, 2}));

/// A flash leaves no more behind than any other light, however much brighter it is than what stays.
TEST(LayeredCube, AFlashLeavesNothingBehind) {
  CubeWorld w;
  w.lights = {lightAt({0, -0.99f, 0}, {0, 1, 0}, vec3(1)), lightAt({0.5f, -0.99f, 0}, {0, 1, 0}, vec3(2, 1, 0))};
  w.room();
  const CubeSettings settings = smallCube();
  LayeredCube cube, fresh;
  fresh.update(w.inputs(settings));
  cube.update(w.inputs(settings));
  const VirtualLight before = w.lights[1];
  for (const bool gone : {false, true})
    for (const float times : {1e12f, 1e18f, 1e28f}) {
      w.lights[1].radiance = before.radiance * times;
      cube.update(w.inputs(settings));
      if (gone) w.lights[1].alive = false;
      if (gone) cube.update(w.inputs(settings));
      w.lights[1] = before;
      cube.update(w.inputs(settings));
      for (size_t e = 0; e < fresh.surfaces().entries().size(); ++e)
        ASSERT_LE(glm::length(cube.irradiance(e) - fresh.irradiance(e)), 1e-5f * glm::length(fresh.irradiance(e)))
            << times << ' ' << gone;
    }
}

TEST(LayeredCube, WhatNothingChangedAsksNoRay) {
  LitWorld w;
  const CubeSettings settings = smallCube();
  LayeredCube cube;
  const CubeInputs in = w.inputs(settings);
  EXPECT_TRUE(cube.update(in).changed);
  const CubeWork again = cube.update(in);
  EXPECT_FALSE(again.changed);
  EXPECT_EQ(again.rays.closest + again.rays.occlusion, 0u);
  // One light less: it alone is taken out, and nothing is asked.
  std::ranges::find_if(w.lights, &VirtualLight::alive)->alive = false;
  const CubeWork less = cube.update(in);
  EXPECT_EQ(less.lightsOut, 1u);
  EXPECT_EQ(less.lightsIn, 0u);
  EXPECT_EQ(less.rays.occlusion, 0u);
}

/// As many words of bits, and other lights in them.
TEST(LayeredCube, FewerSlotsLeaveNoLightBehind) {
  CubeWorld w;
  w.room();
  for (int i = 0; i < 20; ++i) w.lights.push_back(lightAt({0.09f * float(i) - 0.9f, -0.99f, 0}, {0, 1, 0}, vec3(1)));
  const CubeSettings settings = smallCube(CubeVisibility::Rays, 16);
  LayeredCube cube, anew;
  cube.update(w.inputs(settings));
  w.lights.resize(5);
  cube.update(w.inputs(settings));
  anew.update(w.inputs(settings));
  for (size_t e = 0; e < anew.surfaces().entries().size(); ++e)
    ASSERT_LT(glm::length(cube.irradiance(e) - anew.irradiance(e)), 1e-6f);
}

TEST(LayeredCube, ALightThatWasBlackIsLookedAtWhenItShines) {
  CubeWorld w;
  w.room();
  w.lights.push_back(lightAt({0, -0.99f, 0}, {0, 1, 0}, vec3(0)));
  const CubeSettings settings = smallCube(CubeVisibility::Rays, 16);
  LayeredCube cube;
  cube.update(w.inputs(settings));
  w.lights[0].radiance = vec3(100);
  cube.update(w.inputs(settings));
  float most = 0;
  for (size_t e = 0; e < cube.surfaces().entries().size(); ++e) most = std::max(most, cube.irradiance(e).x);
  EXPECT_GT(most, 0.1f);
}

/// A hemicube's texels are wider than the rays that ask for each entry: they disagree along the edges of shadows.
TEST(LayeredCube, HemicubesSeeWhatRaysSee) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  LitWorld w;
  double difference[2] = {}, sum = 0;
  LayeredCube byRays;
  byRays.update(w.inputs(smallCube()));
  for (int fine = 0; fine < 2; ++fine) {
    CubeSettings settings = smallCube(CubeVisibility::Hemicubes);
    settings.hemicube = fine ? 128 : 32;
    LayeredCube cube;
    cube.update(w.inputs(settings));
    ASSERT_EQ(cube.surfaces().entries().size(), byRays.surfaces().entries().size());
    for (size_t e = 0; e < cube.surfaces().entries().size(); ++e) {
      difference[fine] += luminance(glm::abs(cube.irradiance(e) - byRays.irradiance(e)));
      if (!fine) sum += luminance(byRays.irradiance(e));
    }
  }
  EXPECT_LT(difference[1], 0.06 * sum);
  EXPECT_LT(difference[1], 0.7 * difference[0]);
}

/// Hemicubes of 2048 texels a side are made five at a time: each light is put in once, whatever its turn. These lights
/// have half as many texels, which takes a quarter of the time.
TEST(LayeredCube, HemicubesAreMadeInTurns) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  CubeWorld w;
  w.room();
  for (int i = 0; i < 7; ++i) w.lights.push_back(lightAt({-0.5f + 0.14f * float(i), -0.999f, 0}, {0, 1, 0}, vec3(1)));
  CubeSettings settings = smallCube(CubeVisibility::Hemicubes, 16);
  settings.hemicube = 2048;
  LayeredCube byHemicubes, byRays;
  CubeInputs in = w.inputs(settings);
  in.firstLights = 0;
  EXPECT_EQ(byHemicubes.update(in).lightsIn, 7u);
  settings.visibility = CubeVisibility::Rays;
  byRays.update(w.inputs(settings));
  double sum = 0, off = 0;
  for (size_t e = 0; e < byRays.surfaces().entries().size(); ++e) {
    sum += double(luminance(byRays.irradiance(e)));
    off += double(luminance(glm::abs(byRays.irradiance(e) - byHemicubes.irradiance(e))));
  }
  EXPECT_GT(sum, 0);
  EXPECT_LT(off, 0.03 * sum);
}

/// Refused before anything is cast, or once it is known how many surfaces there are; both ways nothing stays behind of
/// the cube before, nor of the one that did not fit.
TEST(LayeredCube, WhatDoesNotFitIsRefused) {
  LitWorld w;
  CubeSettings settings = smallCube(CubeVisibility::Hemicubes, 16);
  LayeredCube cube;
  const auto update = [&](size_t memory) {
    CubeInputs in = w.inputs(settings);
    in.memory = memory;
    return cube.update(in);
  };
  constexpr size_t kEnough = size_t(1) << 30;
  EXPECT_GT(update(kEnough).lightsIn, 0u);
  std::vector<vec3> first;
  for (size_t e = 0; e < cube.surfaces().entries().size(); ++e) first.push_back(cube.irradiance(e));
  for (const size_t memory : {size_t(100'000), size_t(4) << 20}) { // columns; hemicubes of all lights
    settings.resolution = 32;
    EXPECT_THROW(update(memory), RunError) << memory;
    EXPECT_TRUE(cube.surfaces().empty()) << memory;
    settings.resolution = 16;
    EXPECT_GT(update(kEnough).lightsIn, 0u);
    ASSERT_EQ(cube.surfaces().entries().size(), first.size());
    for (size_t e = 0; e < first.size(); ++e) ASSERT_EQ(cube.irradiance(e), first[e]) << e;
  }
  settings.resolution = 32;
  settings.visibility = CubeVisibility::Rays;
  EXPECT_NE(messageOf<RunError>([&] { update(400'000); }).find("the layered depth cube needs"), std::string::npos)
      << "its columns are not cast";
  settings.resolution = 16;
  settings.levels = 3;
  settings.split = 0;
  EXPECT_NE(messageOf<RunError>([&] { update(1 << 20); }).find("the tree"), std::string::npos);
  EXPECT_TRUE(cube.surfaces().empty());
}

/// While objects move too.
TEST(LayeredCube, WhatMovesAndDoesNotFitIsRefused) {
  RandomWorld world(0.01f);
  const SceneView& first = world.step(0);
  VplSet set;
  const std::vector<VirtualLight> lights = photonLights(first, world.rays(), set);
  Aabb room;
  room.add(vec3(-4, -1, -4)), room.add(vec3(4, 4, 4));
  const GatherSettings gather;
  for (const int levels : {0, 2}) {
    CubeSettings settings = smallCube(CubeVisibility::Rays, 16);
    settings.levels = levels;
    LayeredCube cube, anew;
    cube.update({room, world.rays(), kNothingMoved, true, lights, ~0u, settings, gather});
    const DirtyRegion moved(world.step(2));
    CubeInputs in{room, world.rays(), moved, false, lights, ~0u, settings, gather};
    for (const size_t memory : {size_t(1000), size_t(100'000)}) { // of columns; of sums
      in.memory = memory;
      EXPECT_THROW(cube.update(in), RunError) << memory;
      EXPECT_TRUE(cube.surfaces().empty());
      in.memory = 0;
      cube.update(in);
    }
    anew.update(in);
    ASSERT_EQ(cube.surfaces().entries().size(), anew.surfaces().entries().size());
    for (size_t e = 0; e < anew.surfaces().entries().size(); ++e) ASSERT_EQ(cube.irradiance(e), anew.irradiance(e));
  }
}

/// Bytes of an entry while things move: 80 of itself; 24 of its light, and a bit for each light that it may see.
TEST(LayeredCube, EntriesAndWhatTheySeeCountAgainstMemoryEach) {
  struct Row {
    size_t lights, bytes;
  };
  for (const auto& [slots, bytes] : {Row{64, 60}, Row{1024, 130}}) {
    RandomWorld world(0.01f);
    const SceneView& first = world.step(0);
    VplSet set;
    std::vector<VirtualLight> lights = photonLights(first, world.rays(), set);
    lights.resize(slots);
    Aabb room;
    room.add(vec3(-4, -1, -4)), room.add(vec3(4, 4, 4));
    const GatherSettings gather;
    const CubeSettings settings = smallCube(CubeVisibility::Rays, 16);
    LayeredCube cube;
    cube.update({room, world.rays(), kNothingMoved, true, lights, ~0u, settings, gather});
    const DirtyRegion moved(world.step(2));
    CubeInputs in{room, world.rays(), moved, false, lights, ~0u, settings, gather};
    in.memory = cube.surfaces().entries().size() * bytes;
    EXPECT_THROW(cube.update(in), RunError) << slots;
    in.memory = cube.surfaces().entries().size() * 10 + 10'000'000;
    EXPECT_NO_THROW(cube.update(in)) << slots;
  }
}

TEST(LayeredCube, LightsMayBePutInAFewAtATime) {
  LitWorld w;
  const CubeSettings settings = smallCube();
  const CubeInputs in = w.inputs(settings);
  LayeredCube whole, parts;
  whole.update(in);
  uint32_t left = ~0u;
  int calls = 0;
  do {
    EXPECT_LE(parts.update(in, 10).lightsIn, 10u);
    EXPECT_LT(parts.pending(), left);
    left = parts.pending();
  } while (left > 0 && ++calls < 100);
  EXPECT_GT(calls, 4);
  for (size_t e = 0; e < whole.surfaces().entries().size(); ++e)
    ASSERT_LT(glm::length(whole.irradiance(e) - parts.irradiance(e)), 1e-6f * (1 + glm::length(whole.irradiance(e))));
}

} // namespace lambent::test::layered_cube_test
