// What lies behind the texels of the layered depth cube.
#include "engine/core/rng.h"
#include "engine/trace/analytic_query.h"
#include "tests/support/cube_world.h"
#include "tests/support/effort.h"

namespace lambent::test::cube_surfaces_test {

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
  EXPECT_NEAR(least, wide.texel() / 32, 1e-4f) << "five levels";
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
        EXPECT_FALSE(surfaces.holds({lo - 1.5f * size, lo + size})) << i;
        EXPECT_FALSE(surfaces.holds({lo, lo + 0.3f * size})) << i;
      }
    }
  }
}

} // namespace lambent::test::cube_surfaces_test
