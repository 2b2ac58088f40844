// Patches as the papers have them: a finest size, split by depth, upsampled without regard to surfaces.
#include "multires_fixture.h"

namespace lambent::test::multires_choices_test {

/// A tilted square before nothing: its outline crosses patches of every size.
struct Island {
  HandScene scene;
  std::vector<VirtualLight> lamp{lightAt(vec3(0, 0, 1e6f), vec3(0, 0, -1), vec3(1e12f), 1)}; // the same everywhere

  Island() {
    scene.quad(vec3(-1, -0.2f, 0), vec3(1.2f, -0.8f, 0), vec3(0.8f, 1.2f, 0), scene.material(vec3(0.5f)));
    scene.camera = cameraAt(vec3(0, 0, 3), vec3(0), 0.9f, 131, 77);
  }
};

TEST_F(MultiresTest, NoPatchIsSmallerThanTheFinest) {
  const GBuffer gbuffer = roomSurfaces(128, 96);
  uint64_t before = ~0ull;
  for (int level = 0; level <= 4; ++level) {
    const MultiresSettings settings{.coarsest = 8, .finest = 1 << level};
    multires(gbuffer, roomLights(), settings);
    const std::vector<int> levels = patchLevels(gbuffer);
    EXPECT_EQ(*std::ranges::min_element(levels), level); // the room has edges
    const uint64_t count = patchesOf(levels, 128, 96);
    EXPECT_EQ(patchesMarked(gbuffer, settings), count);
    EXPECT_LT(count, before);
    before = count;
    // Without thresholds nothing is larger either.
    MultiresSettings all = settings;
    all.depth = 0;
    EXPECT_EQ(patchesMarked(gbuffer, all), uint64_t(128 * 96) >> (2 * level));
  }
  // 4 × 4 subsets have patches of 4 × 4 pixels anyway.
  const auto subsets = [&](int finest) {
    return patchesMarked(gbuffer, {.coarsest = 8, .finest = finest, .depth = 0}, GatherMode::MultiresInterleaved);
  };
  EXPECT_EQ(subsets(4), 128u * 96);
  EXPECT_EQ(subsets(8), 128u * 96 / 4);
}

/// What makes a patch of the finest size split if it might be, splits those that it is part of.
TEST_F(MultiresTest, AboveTheFinestPatchesAreThoseOfPixels) {
  const GBuffer gbuffer = roomSurfaces(128, 96);
  for (const bool edges : {true, false}) {
    multires(gbuffer, roomLights(), {.coarsest = 8, .balance = false, .edges = edges});
    const std::vector<int> single = patchLevels(gbuffer);
    multires(gbuffer, roomLights(), {.coarsest = 8, .finest = 4, .balance = false, .edges = edges});
    const std::vector<int> coarse = patchLevels(gbuffer);
    for (size_t i = 0; i < single.size(); ++i) ASSERT_EQ(coarse[i], std::max(2, single[i]));
  }
  multires(gbuffer, roomLights(), {.coarsest = 8, .finest = 4});
  const std::vector<int> levels = patchLevels(gbuffer);
  for (const auto [x, y] : Pixels(127, 95))
    for (const int other : {y * 128 + x + 1, (y + 1) * 128 + x, (y + 1) * 128 + x + 1})
      ASSERT_LE(std::abs(levels[size_t(y) * 128 + x] - levels[size_t(other)]), 1) << "balance";
}

/// A patch that would be split and may not has no parts to be balanced against.
TEST_F(MultiresTest, PatchesOfTheFinestSizeSplitNoneBesideThem) {
  const Panels panels(9.854f); // up to pixel 76
  const HandScene& scene = panels.scene;
  multires(surfaces(scene), roomLights(), {.coarsest = 4, .finest = 8, .edges = false});
  const std::vector<int> levels = patchLevels(surfaces(scene));
  for (int x = 64; x < 80; ++x) ASSERT_EQ(levels[size_t(x)], 3) << x;
  for (int x = 80; x < 96; ++x) ASSERT_EQ(levels[size_t(x)], 4) << x;
  for (int x = 96; x < 128; ++x) ASSERT_EQ(levels[size_t(x)], 5) << x;
}

/// The pixel at the middle of a patch may show nothing.
TEST_F(MultiresTest, FinestPatchesLightEveryPixelOfASurface) {
  const Island island;
  const GBuffer gbuffer = surfaces(island.scene);
  const Image full = gathered(gbuffer, island.lamp, GatherMode::Full);
  int seen = 0;
  for (const vec3& e : full.pixels) seen += e.x > 0;
  ASSERT_GT(seen, 1000);
  ASSERT_LT(seen, 6000);
  for (const GatherMode mode :
       {GatherMode::Multires, GatherMode::Splat, GatherMode::SplatPerVpl, GatherMode::MultiresInterleaved})
    for (const int finest : {2, 8, 32, 1024})
      for (const PatchUpsample upsample : {PatchUpsample::Bilateral, PatchUpsample::Bilinear}) {
        const std::vector<VirtualLight> lamps(mode == GatherMode::MultiresInterleaved ? 16 : 1, island.lamp[0]);
        const Image image = multires(gbuffer, lamps, {.coarsest = 4, .finest = finest, .upsample = upsample}, mode);
        const float factor = float(lamps.size());
        for (size_t i = 0; i < full.pixels.size(); ++i)
          ASSERT_NEAR(image.pixels[i].x, full.pixels[i].x * factor, 2e-4f * factor) << int(mode) << ' ' << finest;
      }
}

TEST_F(MultiresTest, SplattingIsGatheringAtFinestPatchesToo) {
  const GBuffer gbuffer = roomSurfaces();
  const MultiresSettings settings{.coarsest = 4, .finest = 4, .light = 0};
  const Image gather = multires(gbuffer, roomLights(), {.coarsest = 4, .finest = 4});
  const Image splat = multires(gbuffer, roomLights(), settings, GatherMode::Splat);
  for (size_t i = 0; i < gather.pixels.size(); ++i)
    ASSERT_NEAR(splat.pixels[i].y, gather.pixels[i].y, 2e-5f * gather.pixels[i].y + 1e-6f);
  // With lists of each VPL's own that are split as far as may be.
  const Image whole = multires(gbuffer, roomLights(), {.coarsest = 4, .finest = 4, .depth = 0});
  const Image each = multires(gbuffer, roomLights(), settings, GatherMode::SplatPerVpl);
  double difference = 0, sum = 0;
  for (size_t i = 0; i < gather.pixels.size(); ++i)
    difference += std::abs(each.pixels[i].y - whole.pixels[i].y), sum += whole.pixels[i].y;
  EXPECT_LT(difference, 0.01 * sum);
}

/// Paper 2, 3.3.1, over view depths that nothing but the picture tells.
TEST_F(MultiresTest, DepthSplitsWhereItsRangeIsTooLarge) {
  const GBuffer gbuffer = roomSurfaces(128, 96);
  const std::vector<float> depth = depths(gbuffer);
  for (const float threshold : {0.01f, 0.05f, 0.3f}) {
    multires(gbuffer, roomLights(),
             {.coarsest = 8,
              .criterion = PatchCriterion::Depth,
              .depth = threshold,
              .normal = 10,
              .balance = false,
              .edges = false});
    const std::vector<int> levels = patchLevels(gbuffer);
    for (const auto [x, y] : Pixels(128, 96)) {
      int expected = 0;
      for (int level = 1; level <= patches->levels; ++level) {
        float lo = kInfinity, hi = 0; // inverse
        for (int j = y >> level << level; j < std::min(96, ((y >> level) + 1) << level); ++j)
          for (int i = x >> level << level; i < ((x >> level) + 1) << level; ++i) {
            lo = std::min(lo, depth[size_t(j) * 128 + i]);
            hi = std::max(hi, depth[size_t(j) * 128 + i]);
          }
        if ((hi - lo) * (1 / lo) < threshold) expected = level;
      }
      ASSERT_EQ(levels[size_t(y) * 128 + x], expected) << x << ' ' << y << ' ' << threshold;
    }
  }
}

TEST_F(MultiresTest, DepthFiresOnAFloorAtAGrazingAngleWhereThePlaneDoesNot) {
  HandScene scene;
  scene.quad(vec3(-500, 0, 500), vec3(1000, 0, 0), vec3(0, 0, -1000), scene.material(vec3(0.5f)));
  scene.camera = cameraAt(vec3(3, 0.5f, 10), vec3(0, 0.2f, 0), 0.05f, 256, 192); // 2° above the floor
  const GBuffer gbuffer = surfaces(scene);
  EXPECT_EQ(patchesMarked(gbuffer, {.coarsest = 4}), 12u);
  EXPECT_GT(patchesMarked(gbuffer, {.coarsest = 4, .criterion = PatchCriterion::Depth}), 1000u);
  // Both find a step, and nothing on a wall that faces the camera.
  Panels panels;
  const GBuffer step = surfaces(panels.scene);
  for (const PatchCriterion criterion : {PatchCriterion::Plane, PatchCriterion::Depth}) {
    multires(step, panels.lamp, {.coarsest = 4, .criterion = criterion});
    const std::vector<int> levels = patchLevels(step);
    EXPECT_EQ(levels[0], patches->levels);
    EXPECT_EQ(levels[size_t(40) * 128 + 127], patches->levels);
    int small = 0;
    for (int x = 0; x < 128; ++x) small += levels[size_t(40) * 128 + x] <= 1;
    EXPECT_EQ(small, 8) << "two patches of 2 × 2 pixels on either side";
  }
}

/// Where an edge runs between patches. One within a patch splits it to pixels, which are not interpolated.
TEST_F(MultiresTest, BilinearLeaksOverAnEdgeAndBilateralDoesNot) {
  Panels panels;
  const GBuffer gbuffer = surfaces(panels.scene);
  const Image full = gathered(gbuffer, panels.lamp, GatherMode::Full);
  // Shares of the light beside the edge: on its dark side, and missing on its lit side.
  const auto leaked = [&](PatchUpsample upsample, bool edges, int finest) {
    const Image image =
        multires(gbuffer, panels.lamp, {.coarsest = 4, .finest = finest, .edges = edges, .upsample = upsample});
    double dark = 0, missing = 0, all = 0;
    for (const auto [x, y] : Pixels({56, 0}, {72, 64})) {
      const float light = image.at(x, y).x, right = full.at(x, y).x;
      EXPECT_EQ(right > 0, x >= 64);
      (right == 0 ? dark : missing) += right == 0 ? light : std::max(0.0f, right - light);
      all += right;
    }
    return std::pair(dark / all, missing / all);
  };
  for (const bool edges : {true, false})
    for (const int finest : {1, 8}) EXPECT_LT(leaked(PatchUpsample::Bilateral, edges, finest).first, 1e-6);
  for (const auto& [edges, finest] : {std::pair(true, 8), {false, 1}, {false, 8}})
    EXPECT_GT(leaked(PatchUpsample::Bilinear, edges, finest).first, 0.03) << finest << edges;
  // Of patches of 2 × 2 pixels the dark ones stand for the first lit column too.
  EXPECT_LT(leaked(PatchUpsample::Bilateral, true, 1).second, 0.02);
  EXPECT_GT(leaked(PatchUpsample::Bilinear, true, 1).second, 0.05);
}

/// Paper 2, section 3.5, done once more from every pixel's light.
TEST_F(MultiresTest, BilinearIsThePapersUpsampling) {
  const GBuffer gbuffer = roomSurfaces();
  const Image full = gathered(gbuffer, roomLights(), GatherMode::Full);
  const Image image =
      multires(gbuffer, roomLights(), {.coarsest = 4, .balance = false, .upsample = PatchUpsample::Bilinear});
  const std::vector<int> levels = patchLevels(gbuffer);
  ASSERT_EQ(patches->levels, 4);
  struct Level {
    int width, height;
    std::vector<std::optional<float>> light;
  };
  Level coarse{0, 0, {}};
  for (int level = 4; level >= 0; --level) {
    Level fine{64 >> level, 48 >> level, {}};
    for (const auto [x, y] : Pixels(fine)) {
      std::optional<float>& light = fine.light.emplace_back();
      const ivec2 centre = patchCentre(ivec2(x, y), level);
      if (levels[size_t(y << level) * 64 + (x << level)] == level) {
        light = full.at(centre.x, 47 - centre.y).y;
        continue;
      }
      if (level == 4 || !coarse.light[size_t(y / 2 * coarse.width + x / 2)]) continue;
      const vec2 at = (vec2(centre) - vec2(patchCentre(ivec2(0), level + 1))) / float(2 << level); // coarse texels
      float sum = 0, weights = 0;
      for (int j = 0; j < coarse.height; ++j)
        for (int i = 0; i < coarse.width; ++i) {
          const vec2 away = glm::abs(at - vec2(i, j));
          const std::optional<float>& value = coarse.light[size_t(j * coarse.width + i)];
          if (!value || away.x >= 1 || away.y >= 1) continue;
          sum += (1 - away.x) * (1 - away.y) * *value;
          weights += (1 - away.x) * (1 - away.y);
        }
      light = sum / weights;
    }
    coarse = std::move(fine);
  }
  for (const auto [x, y] : Pixels(64, 48)) {
    const float expected = *coarse.light[size_t(y) * 64 + x];
    ASSERT_NEAR(image.at(x, 47 - y).y, expected, 1e-4f * expected) << x << ' ' << y;
  }
}

/// As the paper's figure 3: nothing comes from texels that hold no light, and nothing goes to them.
TEST_F(MultiresTest, AConstantStaysConstantUpsampledEitherWay) {
  const GBuffer gbuffer = roomSurfaces(131, 77);
  std::vector<VirtualLight> lights;
  for (const vec3& axis : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)})
    for (const float side : {-1e6f, 1e6f}) lights.push_back(lightAt(side * axis, -side / 1e6f * axis, vec3(1e12f), 1));
  for (const PatchUpsample upsample : {PatchUpsample::Bilateral, PatchUpsample::Bilinear})
    for (const int finest : {1, 4})
      for (const bool balance : {true, false})
        for (const vec3& e :
             multires(gbuffer, lights,
                      {.coarsest = 4, .finest = finest, .balance = balance, .edges = balance, .upsample = upsample})
                 .pixels)
          ASSERT_NEAR(e.x, 1, byHalfFloats(2e-5f, 8e-4f));
}

/// Glossy light too.
TEST_F(MultiresTest, GlossyLightOfFinestPatchesIsUpsampledEitherWay) {
  const GBuffer gbuffer = glossyRoomSurfaces();
  float lo = kInfinity, hi = 0;
  for (const vec4& g : glossyTexels(gbuffer, GatherMode::Full, {})) lo = std::min(lo, g.x), hi = std::max(hi, g.x);
  for (const PatchUpsample upsample : {PatchUpsample::Bilateral, PatchUpsample::Bilinear})
    for (const vec4& g :
         glossyTexels(gbuffer, GatherMode::Multires, {.coarsest = 4, .finest = 2, .upsample = upsample})) {
      ASSERT_GE(g.x, 0.9999f * lo);
      ASSERT_LE(g.x, 1.0001f * hi);
    }
}

} // namespace lambent::test::multires_choices_test
