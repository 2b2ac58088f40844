// The layered depth cube: surfaces found along the axes, light put in and taken out, and the file that keeps it.
#include "engine/trace/analytic_query.h"
#include "engine/view/scene_hash.h"
#include "gi/cube/cube_file.h"
#include "gi/lighting/light_set.h"
#include "gi/vpl/sources.h"
#include "tests/support/effort.h"
#include "tests/support/files.h"
#include "tests/support/random_world.h"

#include <cstddef>
#include <cstring>

namespace lambent::test::layered_cube_test {

CubeSettings smallCube(CubeVisibility sights = CubeVisibility::Rays, int resolution = 32) {
  return {.resolution = resolution, .visibility = sights, .hemicube = 64};
}

VirtualLight lightAt(const vec3& position, const vec3& normal, const vec3& power, float area = 0.01f) {
  return {position, normal, normal, power / area, area, true};
}

/// Rooms made by hand, and a cube over them.
struct CubeWorld {
  HandScene scene;
  std::unique_ptr<EmbreeQuery> rays;
  SceneView view;
  GatherSettings gather;
  std::vector<VirtualLight> lights;

  void place() {
    rays = std::make_unique<EmbreeQuery>(scene.assets);
    view = scene.view();
    rays->update(view, true);
  }
  /// A closed one.
  void room() {
    scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
    place();
  }
  CubeInputs inputs(const CubeSettings& settings) {
    return {view.boundsWorld, *rays, kNothingMoved, false, lights, ~0u, settings, gather};
  }
  CubeSurfaces surfaces(const CubeSettings& settings = smallCube()) const {
    CubeSurfaces built;
    RayCounts counts;
    built.build(view.boundsWorld, settings, *rays, counts);
    EXPECT_GT(counts.closest, 0u);
    return built;
  }
};

TEST(CubeSurfaces, AFloorIsALayerOnEachOfItsSides) {
  CubeWorld w;
  w.scene.quad({0, 1, 0}, {0, 0, 4}, {4, 0, 0}, w.scene.material(vec3(0.5f)));
  w.place();
  const CubeSurfaces surfaces = w.surfaces();
  size_t up = 0, down = 0;
  const CubeGrid grid = surfaces.cubes()[0];
  for (size_t c = 0; c < surfaces.columns(); ++c) {
    const CubeGrid::Place at = grid.placeOf(c);
    EXPECT_EQ(grid.column(at.axis, at.u, at.v), c);
    for (uint32_t e = surfaces.firsts()[c]; e < surfaces.firsts()[c + 1]; ++e) {
      const CubeEntry& entry = surfaces.entries()[e];
      ASSERT_EQ(at.axis, 1);
      EXPECT_NEAR(entry.position.y, 1, 1e-5f);
      EXPECT_NEAR(entry.position.z, grid.corner.z + (float(at.u) + 0.5f) * grid.texel, 1e-4f);
      EXPECT_NEAR(entry.position.x, grid.corner.x + (float(at.v) + 0.5f) * grid.texel, 1e-4f);
      (entry.normal.y > 0 ? up : down)++;
    }
  }
  EXPECT_EQ(up, 30u * 30u); // a texel on every side lies outside
  EXPECT_EQ(down, up);
  // Every one within sees its eight neighbours, none past the rim.
  const size_t middle = grid.column(1, 16, 16), corner = grid.column(1, 1, 1);
  EXPECT_EQ(surfaces.entries()[surfaces.firsts()[middle]].neighbours, 255u);
  EXPECT_EQ(surfaces.entries()[surfaces.firsts()[corner]].neighbours, 1u | 4u | 16u);
}

TEST(CubeSurfaces, NeighboursBehindAWallAreNotLinked) {
  CubeWorld w;
  const uint32_t grey = w.scene.material(vec3(0.5f));
  w.scene.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
  w.scene.quad({2.03f, 0, 0}, {0, 0, 4}, {0, 4, 0}, grey); // through texels, not between them
  w.place();
  const CubeSurfaces surfaces = w.surfaces();
  size_t across = 0, along = 0;
  const CubeGrid grid = surfaces.cubes()[0];
  for (size_t c = 0; c < surfaces.columns(); ++c) {
    const CubeGrid::Place at = grid.placeOf(c);
    if (at.axis != 1) continue;
    for (uint32_t e = surfaces.firsts()[c]; e < surfaces.firsts()[c + 1]; ++e) {
      const CubeEntry& entry = surfaces.entries()[e];
      if (entry.normal.y < 0 || std::abs(entry.position.x - 2.03f) > 0.4f * grid.texel) continue;
      // v runs along x: the way over the wall is +v from this side, -v from the other.
      across += entry.neighbours >> (entry.position.x < 2.03f ? 2 : 3) & 1;
      along += entry.neighbours & 1;
    }
  }
  EXPECT_EQ(across, 0u);
  EXPECT_GT(along, 20u);
}

/// Sheets behind one another, three columns wide, on a floor: each is there, and what a column has no room for is told.
/// (Of the three outermost, whose outer sides see one another within a third of a texel, one side is kept.)
TEST(CubeSurfaces, ManySheetsBehindOneAnother) {
  for (const int sheets : {100, 260}) {
    if (kSanitized && sheets > 100) continue; // CubeFileTest cuts a smaller pile
    CubeWorld w;
    const uint32_t grey = w.scene.material(vec3(0.5f));
    constexpr float kColumn = 4.0f / 14; // a texel on every side lies outside
    w.scene.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
    for (int i = 1; i < sheets; ++i)
      w.scene.quad({5 * kColumn, 0.01f * float(i), 5 * kColumn}, {0, 0, 3 * kColumn}, {3 * kColumn, 0, 0}, grey);
    w.place();
    const CubeSurfaces surfaces = w.surfaces(smallCube(CubeVisibility::Rays, 16));
    const size_t columns = 3 * 3, ofFloor = 2 * (14 * 14 - columns);
    EXPECT_EQ(surfaces.entries().size(), ofFloor + columns * size_t(sheets > 256 ? 2 * 256 - 2 : 2 * sheets - 4));
    EXPECT_EQ(surfaces.columnsCut(), sheets > 256 ? columns : 0);
  }
}

/// A floor, and slabs on it with joints between them, much lower than a texel is wide: what covers stands for both. The
/// floor under a slab sees no light, and would take that of all pixels around.
TEST(CubeSurfaces, SlabsStandForTheFloorUnderThem) {
  CubeWorld w;
  const uint32_t grey = w.scene.material(vec3(0.5f));
  w.scene.quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, grey);
  for (int i = 0; i < 16; ++i) {
    const vec3 at = vec3(i % 4, 0, i / 4);
    w.scene.box(at + vec3(0.01f, -0.01f, 0.01f), at + vec3(0.99f, 0.01f, 0.99f), grey, false);
  }
  w.place();
  w.lights.push_back(lightAt({2, 3, 2}, {0, -1, 0}, vec3(10)));
  const CubeSettings settings = smallCube(CubeVisibility::Rays, 32);
  LayeredCube cube;
  cube.update(w.inputs(settings));
  const CubeSurfaces& surfaces = cube.surfaces();
  const CubeGrid grid = surfaces.cubes()[0];
  ASSERT_GT(grid.texel, 0.1f);
  size_t columns = 0, dark = 0, tops = 0; // dark: of the floor
  for (size_t c = 0; c < surfaces.columns(); ++c) {
    const CubeGrid::Place at = grid.placeOf(c);
    if (at.axis != 1 || std::min(at.u, at.v) < 1 || std::max(at.u, at.v) > 30) continue;
    ++columns;
    for (uint32_t e = surfaces.firsts()[c]; e < surfaces.firsts()[c + 1]; ++e) {
      const CubeEntry& entry = surfaces.entries()[e];
      if (entry.normal.y > 0 && std::abs(entry.position.y) < 5e-3f) dark += !(cube.irradiance(e).x > 0);
      tops += entry.normal.y > 0 && entry.position.y > 5e-3f && cube.irradiance(e).x > 0;
    }
  }
  EXPECT_EQ(columns, 900u);
  EXPECT_EQ(dark, 0u);
  EXPECT_EQ(tops, columns);
}

/// A step through texels, off their middles: where most rays meet the floor it stands for itself.
TEST(CubeSurfaces, AStepDoesNotStandForTheFloorBesideIt) {
  CubeWorld w;
  const uint32_t grey = w.scene.material(vec3(0.5f));
  constexpr int kRow = 15;
  const CubeGrid grid = CubeGrid::over(vec3(0), 4, 32);
  w.scene.quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, grey);
  w.scene.box({grid.corner.x + (kRow + 0.55f) * grid.texel, -0.01f, 0}, {4, 0.01f, 4}, grey, false);
  w.place();
  const CubeSurfaces surfaces = w.surfaces();
  int floors = 0, steps = 0;
  for (int u = 1; u <= 30; ++u) {
    const size_t c = surfaces.cubes()[0].column(1, u, kRow);
    for (uint32_t e = surfaces.firsts()[c]; e < surfaces.firsts()[c + 1]; ++e) {
      const CubeEntry& entry = surfaces.entries()[e];
      floors += entry.normal.y > 0 && std::abs(entry.position.y) < 5e-3f;
      steps += entry.normal.y > 0 && entry.position.y > 5e-3f;
    }
  }
  EXPECT_EQ(floors, 30);
  EXPECT_EQ(steps, 0) << "merged";
}

/// A wide floor with small blocks in one corner: narrow texels there, wide ones on the rest.
TEST(CubeSurfaces, ATreeRefinesWhereThingsAreSmall) {
  CubeWorld w;
  const uint32_t grey = w.scene.material(vec3(0.5f));
  w.scene.quad({0, 0, 0}, {0, 0, 32}, {32, 0, 0}, grey);
  for (int i = 0; i < 9; ++i) {
    const vec3 at = vec3(1 + i % 3, 0.1f, 1 + i / 3);
    w.scene.box(at, at + 0.4f, grey, false);
  }
  w.place();
  CubeSettings settings = smallCube(CubeVisibility::Rays, 16);
  settings.levels = 5;
  const CubeSurfaces tree = w.surfaces(settings), wide = w.surfaces(smallCube(CubeVisibility::Rays, 16)),
                     narrow = w.surfaces(smallCube(CubeVisibility::Rays, 512));
  float least = kInfinity;
  size_t onBlocks = 0;
  for (size_t c = 0; c + 1 < tree.firsts().size(); ++c) {
    const CubeGrid& grid = tree.cubes()[c / tree.columns()];
    least = std::min(least, grid.texel);
    for (uint32_t e = tree.firsts()[c]; e < tree.firsts()[c + 1]; ++e) {
      const vec3 p = tree.entries()[e].position;
      const bool atBlock = p.y > 0.05f && p.x < 4 && p.z < 4;
      if (!atBlock) continue;
      ++onBlocks;
      EXPECT_LT(grid.texel, 0.25f * wide.texel()) << p.x << ' ' << p.z;
    }
  }
  EXPECT_LT(least, 0.1f);
  EXPECT_GT(onBlocks, 9u * 5 * 2 * 9);
  EXPECT_GT(tree.entries().size(), 2 * wide.entries().size());
  EXPECT_LT(tree.entries().size(), narrow.entries().size() / 20);
  // The cubes fill the one over all, but for what their borders overlap.
  double volume = 0;
  for (const CubeGrid& grid : tree.cubes()) volume += std::pow(double(grid.texel) * (grid.resolution - 2), 3);
  EXPECT_NEAR(volume, 32.0 * 32 * 32, 1);
}

/// What was just built holds the box that it was built over: else it would be built again for ever.
TEST(CubeSurfaces, HoldTheBoxTheyWereBuiltOver) {
  AnalyticQuery nothing;
  nothing.addSphere(vec3(0), 1e-3f, {});
  for (uint32_t i = 0; i < 400; ++i) {
    Rng rng(7, Stream::Test, i);
    const auto scale = [&](float least, float most) {
      return std::exp2(std::log2(least) + rng.next() * std::log2(most / least));
    };
    const vec3 size = i % 9 == 0 ? vec3(0) : scale(1e-3f, 1e4f) * (i % 5 == 0 ? vec3(1, 0, 1e-6f) : rng.next3());
    const vec3 lo = scale(1e-3f, 1e5f) * (2.0f * rng.next3() - 1.0f);
    for (const int levels : {0, 3}) {
      CubeSurfaces surfaces;
      RayCounts counts;
      surfaces.build({lo, lo + size}, {.resolution = 8, .levels = levels, .split = 0}, nothing, counts);
      EXPECT_TRUE(surfaces.holds({lo, lo + size})) << i << ", levels " << levels;
      if (maxComponent(size) > 1e-3f * maxComponent(glm::abs(lo))) { // else single precision does not tell them apart
        EXPECT_FALSE(surfaces.holds({lo, lo + 2.5f * size})) << i;
        EXPECT_FALSE(surfaces.holds({lo, lo + 0.3f * size})) << i;
      }
    }
  }
}

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

/// Hemicubes of 1024 texels a side are made five at a time: each light is put in once, whatever its turn.
TEST(LayeredCube, HemicubesAreMadeInTurns) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  CubeWorld w;
  w.room();
  for (int i = 0; i < 7; ++i) w.lights.push_back(lightAt({-0.5f + 0.14f * float(i), -0.999f, 0}, {0, 1, 0}, vec3(1)));
  CubeSettings settings = smallCube(CubeVisibility::Hemicubes, 16);
  settings.hemicube = 1024;
  LayeredCube byHemicubes, byRays;
  EXPECT_EQ(byHemicubes.update(w.inputs(settings)).lightsIn, 7u);
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
  settings.levels = 3;
  settings.split = 0;
  EXPECT_NE(messageOf<RunError>([&] { update(1 << 20); }).find("the tree"), std::string::npos);
  EXPECT_TRUE(cube.surfaces().empty());
  EXPECT_GT(update(kEnough).lightsIn, 0u);
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

class CubeFileTest : public ::testing::Test {
 protected:
  void SetUp() override {

    w.lights = {lightAt({0, -0.99f, 0}, {0, 1, 0}, vec3(1)), lightAt({0.5f, -0.99f, 0}, {0, 1, 0}, vec3(1))};
    w.room();
    key_ = cubeKey(w.view);
  }

  CubeWorld w;
  CubeSettings settings = smallCube(CubeVisibility::Rays, 16);
  TemporaryFolder folder_;
  const fs::path file_ = folder_ / "room.cube";
  uint64_t key_ = 0;
};

TEST_F(CubeFileTest, GivesBackWhatWasSavedAndGoesOn) {
  w.gather.disk = 2.5f; // kept in the file: with other settings a cube begins anew
  LayeredCube half;
  half.update(w.inputs(settings), 1);
  ASSERT_EQ(half.pending(), 1u);
  saveCube(file_, half, key_);
  LayeredCube on = loadCube(file_, key_), whole;
  EXPECT_EQ(on.update(w.inputs(settings)).lightsIn, 1u);
  whole.update(w.inputs(settings));
  for (size_t e = 0; e < whole.surfaces().entries().size(); ++e) ASSERT_EQ(on.irradiance(e), whole.irradiance(e));
}

TEST_F(CubeFileTest, KnowsOfColumnsThatWereCut) {
  settings.resolution = 8;
  for (int i = 0; i < 260; ++i)
    w.scene.quad({0, -0.9f + 0.005f * float(i), 0}, {0, 0, 0.3f}, {0.3f, 0, 0}, w.scene.material(vec3(0.5f)));
  w.place();
  LayeredCube cube;
  cube.update(w.inputs(settings));
  ASSERT_GT(cube.surfaces().columnsCut(), 0u);
  saveCube(file_, cube, key_);
  EXPECT_EQ(loadCube(file_, key_).surfaces().columnsCut(), cube.surfaces().columnsCut());
}

/// What memory holds between members does not reach the file. (After those of lights: tests/cli/busy.)
TEST_F(CubeFileTest, TheSameCubeHasTheSameBytes) {
  const auto bytesWith = [&](int between) {
    constexpr size_t kBegin = offsetof(GatherSettings, glossy) + 1;
    std::memset(reinterpret_cast<char*>(&w.gather) + kBegin, between, offsetof(GatherSettings, spread) - kBegin);
    LayeredCube cube;
    cube.update(w.inputs(settings));
    saveCube(file_, cube, key_);
    return readBytes(file_);
  };
  EXPECT_EQ(bytesWith(0x55), bytesWith(0xaa));
}

TEST_F(CubeFileTest, SaysWhatIsWrongWithAFile) {
  LayeredCube cube;
  cube.update(w.inputs(settings));
  saveCube(file_, cube, key_);
  EXPECT_THROW(loadCube(file_, key_ + 1), InputError);
  const std::string good = readBytes(file_);
  EXPECT_NO_THROW(loadCube(file_, key_));
  for (size_t at = 0; at < good.size(); at += 997) {
    std::string bad = good;
    bad[at] = char(bad[at] ^ 0x55);
    writeBytes(file_, bad);
    EXPECT_THROW(loadCube(file_, key_), InputError) << at;
  }
  for (const size_t size : {size_t(0), size_t(10), size_t(24), size_t(100), good.size() / 2, good.size() - 1}) {
    writeBytes(file_, good.substr(0, size));
    EXPECT_THROW(loadCube(file_, key_), InputError) << size;
  }
  writeBytes(file_, good + '\0');
  EXPECT_THROW(loadCube(file_, key_), InputError);
}

TEST_F(CubeFileTest, BelongsToTheGeometryNotToTheLights) {
  HandScene other;
  other.box(vec3(-1), vec3(1.01f), other.material(vec3(0.5f)), true);
  EXPECT_NE(cubeKey(other.view()), key_);
  w.scene.lights.push_back({.type = LightType::Point, .intensity = vec3(1)});
  EXPECT_EQ(cubeKey(w.scene.view()), key_);
}

} // namespace lambent::test::layered_cube_test
