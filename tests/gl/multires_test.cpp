// The multiresolution buffer: which patches it takes, what it gathers there, and how pixels get their light back.
#include "multires_fixture.h"

namespace lambent::test::multires_test {

TEST_F(MultiresTest, ThresholdZeroIsTheGatherAtEveryPixel) {
  for (const glm::ivec2 size : {glm::ivec2(64, 48), glm::ivec2(131, 77)}) {
    const GBuffer gbuffer = roomSurfaces(size.x, size.y);
    const MultiresSettings settings{.coarsest = 4, .depth = 0};
    const Image full = gathered(gbuffer, roomLights(), GatherMode::Full);
    EXPECT_EQ(multires(gbuffer, roomLights(), settings).pixels, full.pixels);
    const Image subsets = gathered(gbuffer, roomLights(), GatherMode::Interleaved);
    EXPECT_EQ(multires(gbuffer, roomLights(), settings, GatherMode::MultiresInterleaved).pixels, subsets.pixels);
  }
}

/// Six lights far away, one along each axis, light every face of axis-aligned boxes alike.
TEST_F(MultiresTest, AConstantStaysConstant) {
  const GBuffer gbuffer = roomSurfaces(131, 77);
  std::vector<VirtualLight> lights(16 * 6, VirtualLight{}); // every class has all six
  for (int i = 0; i < 6; ++i) {
    vec3 axis(0);
    axis[i / 2] = i % 2 ? -1.0f : 1.0f;
    for (int c = 0; c < 16; ++c)
      lights[size_t(i) * 16 + c] = lightAt(1e6f * axis, -axis, vec3(1e12f) * vec3(0.5f, 1, 2), 1);
  }
  for (const GatherMode mode : {GatherMode::Multires, GatherMode::Splat, GatherMode::MultiresInterleaved}) {
    const Image image = multires(gbuffer, lights, {.coarsest = 4}, mode);
    for (const vec3& e : image.pixels) {
      ASSERT_NEAR(e.x / 16, 0.5f, byHalfFloats(1e-5f, 4e-4f));
      ASSERT_NEAR(e.z / 16, 2, byHalfFloats(4e-5f, 16e-4f));
    }
    if (mode != GatherMode::Splat) {
      EXPECT_LT(patchesMarked(gbuffer, {.coarsest = 4}, mode), image.pixels.size() * 3 / 4)
          << "or nothing was interpolated";
    }
  }
}

/// Each level is interpolated between the four patches of the next coarser one that are around it, so what comes to a
/// pixel was gathered within one and a half sides of a patch, on surfaces that face its way.
TEST_F(MultiresTest, NothingIsBrighterOrDarkerThanWhatWasGatheredAroundIt) {
  const GBuffer gbuffer = roomSurfaces(128, 96);
  const std::vector<VirtualLight> lights = lightsIn(vec3(0, -0.5f, 0), vec3(0.5f), 40); // none close to a wall
  const Image full = gathered(gbuffer, lights, GatherMode::Full);
  const Image image = multires(gbuffer, lights, {.coarsest = 4});
  const Image normal = surfaceBuffer(Buffer::Normal, gbuffer);
  const std::vector<GatheredPatch> places = gatheredPatches(gbuffer);
  const std::vector<int> levels = patchLevels(gbuffer);
  double sumFull = 0, sum = 0;
  for (const auto [x, y] : Pixels(128, 96)) {
    float lo = kInfinity, hi = 0;
    for (const GatheredPatch& p : places) {
      const glm::ivec2 away = glm::abs(p.pixel - glm::ivec2(x, y));
      const float side = float(1 << std::max(p.level, levels[size_t(y) * 128 + x]));
      if (float(std::max(away.x, away.y)) > 1.5f * side ||
          glm::dot(normal.at(x, 95 - y), normal.at(p.pixel.x, 95 - p.pixel.y)) < 0.5f)
        continue;
      const float light = full.at(p.pixel.x, 95 - p.pixel.y).y;
      lo = std::min(lo, light);
      hi = std::max(hi, light);
    }
    const float light = image.at(x, 95 - y).y;
    ASSERT_GE(light, 0.9999f * lo) << x << ' ' << y;
    ASSERT_LE(light, 1.0001f * hi) << x << ' ' << y;
    sumFull += full.at(x, 95 - y).y;
    sum += light;
  }
  EXPECT_NEAR(sum / sumFull, 1, 0.02);
}

TEST_F(MultiresTest, AFloorAtAGrazingAngleIsOnePatch) {
  HandScene scene;
  const uint32_t grey = scene.material(vec3(0.5f));
  scene.quad(vec3(-500, 0, 500), vec3(1000, 0, 0), vec3(0, 0, -1000), grey);
  scene.camera = cameraAt(vec3(3, 0.5f, 10), vec3(0, 0.2f, 0), 0.05f, 256, 192); // 2° above the floor
  const GBuffer gbuffer = surfaces(scene);
  const MultiresSettings fine{.coarsest = 4, .depth = 0.001f, .normal = 0.01f};
  multires(gbuffer, roomLights(), fine);
  const int levels = patches->levels;
  ASSERT_EQ(levels, 6);
  for (const int level : patchLevels(gbuffer)) ASSERT_EQ(level, levels);
  EXPECT_EQ(patchesMarked(gbuffer, fine), 12u);
  // A step of 4 cm across it is seen, in spite of 20 m of depth in every patch.
  scene.box(vec3(-2.3f, 0, -7), vec3(-1.7f, 0.04f, -6.5f), grey, false);
  const GBuffer stepped = surfaces(scene);
  EXPECT_GT(patchesMarked(stepped, {.coarsest = 4, .depth = 0.001f, .normal = 10}), 50u);
}

/// Straight edges along patch borders, where a plane fitted to four pixels would bridge the step, and bars that are
/// thinner than a patch.
TEST_F(MultiresTest, NoPatchSpansAStep) {
  HandScene scene;
  const uint32_t grey = scene.material(vec3(0.5f));
  scene.quad(vec3(-9, -9, -2), vec3(18, 0, 0), vec3(0, 18, 0), grey);
  scene.quad(vec3(-9, -9, 0), vec3(8.87f, 0, 0), vec3(0, 9.1f, 0), grey); // nearer, lower left
  scene.quad(vec3(1, -9, 0), vec3(0.08f, 0, 0), vec3(0, 18, 0), grey);
  scene.quad(vec3(-9, 1, 0), vec3(18, 0, 0), vec3(0, 0.08f, 0), grey);
  scene.camera = cameraAt(vec3(0, 0, 4), vec3(0), 1.0f, 128, 96);
  const GBuffer gbuffer = surfaces(scene);
  const Image depth = surfaceBuffer(Buffer::Depth, gbuffer);
  for (const auto& [balance, edges] : {std::pair(true, true), std::pair(false, false)}) {
    multires(gbuffer, roomLights(), {.coarsest = 2, .balance = balance, .edges = edges});
    const std::vector<int> levels = patchLevels(gbuffer);
    EXPECT_GE(*std::max_element(levels.begin(), levels.end()), 3) << "or nothing could span a step";
    for (const auto [x, y] : Pixels(128, 96)) { // against the first pixel of its patch
      const int level = levels[size_t(y) * 128 + x];
      ASSERT_NEAR(depth.at(x >> level << level, 95 - (y >> level << level)).x, depth.at(x, 95 - y).x, 0.5f)
          << x << ' ' << y << ", level " << level;
    }
  }
}

/// A patch's plane and its bound hold every pixel, also where the surface bends from patch to patch.
TEST_F(MultiresTest, NoPixelLiesFartherFromItsPlaneThanThePatchSays) {
  HandScene scene;
  const uint32_t grey = scene.material(vec3(0.5f));
  const auto height = [](float x) { return 0.2f * std::sin(4 * x); };
  constexpr float kStep = 0.05f;
  for (int i = -30; i < 30; ++i) {
    const float x = kStep * float(i);
    scene.quad(vec3(x, -2, height(x)), vec3(kStep, 0.5f * kStep, height(x + kStep) - height(x)), vec3(0, 4, 0.3f),
               grey);
  }
  scene.camera = cameraAt(vec3(0.3f, 0, 2), vec3(0), 0.8f, 128, 96);
  const GBuffer gbuffer = surfaces(scene);
  multires(gbuffer, roomLights(), {.coarsest = 4});
  const std::vector<float> depth = depths(gbuffer);
  int bounded = 0;
  for (int level = 1; level <= patches->levels; ++level) {
    const glm::ivec2 size = patches->padded / (1 << level);
    std::vector<vec4> planes(size_t(size.x) * size_t(size.y));
    patches->plane->read(std::span(planes), GL_RGBA, GL_FLOAT, level - 1);
    for (const auto [x, y] : Pixels(128, 96)) {
      const vec4& plane = planes[size_t(y >> level) * size_t(size.x) + size_t(x >> level)];
      const float d = depth[size_t(y) * 128 + size_t(x)];
      if (plane.x <= 0 || plane.w > 1 || d == 0) continue;
      const float middle = 0.5f * float((1 << level) - 1), mask = float((1 << level) - 1);
      const vec2 offset(float(x & int(mask)) - middle, float(y & int(mask)) - middle);
      ASSERT_LE(std::abs(d - plane.x - glm::dot(vec2(plane.y, plane.z), offset)), plane.w * 1.001f + 1e-7f)
          << x << ' ' << y << ", level " << level;
      bounded += level > 2;
    }
  }
  EXPECT_GT(bounded, 1000);
}

TEST_F(MultiresTest, NoPatchHoldsBackground) {
  HandScene scene;
  scene.quad(vec3(-0.77f, -0.63f, 0), vec3(1.3f, 0.1f, 0), vec3(-0.1f, 1.2f, 0), scene.material(vec3(0.5f)));
  scene.camera = cameraAt(vec3(0, 0, 2), vec3(0), 1.0f, 128, 96);
  const GBuffer gbuffer = surfaces(scene);
  multires(gbuffer, roomLights(), {.coarsest = 4, .edges = false});
  const std::vector<float> depth = depths(gbuffer);
  int whole = 0;
  for (int level = 1; level <= patches->levels; ++level) {
    const glm::ivec2 size = patches->padded / (1 << level);
    std::vector<float> split(size_t(size.x) * size_t(size.y)), plane(split.size());
    patches->normalLo->read(std::span(split), GL_ALPHA, GL_FLOAT, level - 1);
    patches->plane->read(std::span(plane), GL_RED, GL_FLOAT, level - 1);
    for (const auto [x, y] : Pixels(128, 96)) {
      const size_t i = size_t(y >> level) * size_t(size.x) + size_t(x >> level);
      if (split[i] > 0.5f || !(plane[i] > 0)) continue;
      ASSERT_GT(depth[size_t(y) * 128 + size_t(x)], 0) << x << ' ' << y << ", level " << level;
      ++whole;
    }
  }
  EXPECT_GT(whole, 1000);
}

TEST_F(MultiresTest, NeighboursDifferByOneLevelAtMost) {
  const GBuffer gbuffer = roomSurfaces(256, 192);
  for (const bool balance : {true, false}) {
    multires(gbuffer, roomLights(), {.coarsest = 4, .balance = balance});
    const std::vector<int> levels = patchLevels(gbuffer);
    int largest = 0;
    for (int y = 0; y + 1 < gbuffer.height; ++y)
      for (int x = 0; x + 1 < gbuffer.width; ++x)
        for (const int other : {y * 256 + x + 1, (y + 1) * 256 + x, (y + 1) * 256 + x + 1})
          largest = std::max(largest, std::abs(levels[size_t(y) * 256 + x] - levels[size_t(other)]));
    if (balance)
      EXPECT_EQ(largest, 1);
    else
      EXPECT_GT(largest, 1) << "or the scene needs no balance";
    EXPECT_EQ(patchesMarked(gbuffer, {.coarsest = 4, .balance = balance}),
              patchesOf(levels, gbuffer.width, gbuffer.height));
  }
}

/// An edge along a border that patches of every size share: the pyramid alone would end the largest ones there.
TEST_F(MultiresTest, PatchesBesideAnEdgeStaySmallWithBalanceOrWithout) {
  const Panels panels;
  const GBuffer gbuffer = surfaces(panels.scene);
  for (const bool balance : {true, false})
    for (const bool edges : {true, false}) {
      multires(gbuffer, roomLights(), {.coarsest = 4, .balance = balance, .edges = edges});
      const std::vector<int> levels = patchLevels(gbuffer);
      ASSERT_EQ(patches->levels, 5);
      for (int y = 0; y < 64; ++y)
        for (const int x : {63, 64}) ASSERT_EQ(levels[size_t(y) * 128 + x], edges ? 1 : 5) << balance << edges;
      EXPECT_EQ(levels[0], 5);
    }
}

/// A light between two panels lights the far one only.
TEST_F(MultiresTest, NoLightLeaksOverAnEdge) {
  const Panels panels(8.87f, 131, 77);
  const GBuffer gbuffer = surfaces(panels.scene);
  const std::vector<VirtualLight>& lights = panels.lamp;
  const Image full = gathered(gbuffer, lights, GatherMode::Full);
  const Image image = multires(gbuffer, lights, {.coarsest = 4});
  int dark = 0, lit = 0;
  for (size_t i = 0; i < full.pixels.size(); ++i) {
    if (full.pixels[i].x == 0) {
      ++dark;
      ASSERT_LT(image.pixels[i].x, 1e-6f);
    } else {
      ++lit;
      ASSERT_GT(image.pixels[i].x, 0);
    }
  }
  EXPECT_GT(dark, 4000);
  EXPECT_GT(lit, 4000);
}

TEST_F(MultiresTest, SplattingIsGatheringTheOtherWayRound) {
  const GBuffer gbuffer = roomSurfaces(131, 77);
  const MultiresSettings settings{.coarsest = 4, .light = 1e9f};
  for (const int count : {40, 2100}) { // two chunks of lights
    const std::vector<VirtualLight> lights = lightsIn(vec3(-0.9f), vec3(0.9f), count);
    const Image gather = multires(gbuffer, lights, settings);
    std::vector<GatherMode> modes{GatherMode::Splat};
    if (count < 100) modes.push_back(GatherMode::SplatPerVpl); // whose lists are all the same without its criterion
    for (const GatherMode mode : modes) {
      const Image splat = multires(gbuffer, lights, settings, mode);
      for (size_t i = 0; i < gather.pixels.size(); ++i)
        ASSERT_NEAR(splat.pixels[i].y, gather.pixels[i].y, 2e-5f * gather.pixels[i].y + 1e-6f);
    }
  }
}

/// Where a VPL stands close to a wall its light changes within a patch that is smooth.
TEST_F(MultiresTest, APatchPerVplFollowsItsLight) {
  const Floor floor;
  const GBuffer gbuffer = surfaces(floor.scene);
  const std::vector lights{lightAt(vec3(0.3f, 0.2f, -0.2f), vec3(0, -1, 0), vec3(1), 0.05f)};
  const Image full = gathered(gbuffer, lights, GatherMode::Full);
  const auto error = [&](const Image& image) {
    double sum = 0;
    for (size_t i = 0; i < full.pixels.size(); ++i) sum += std::pow(image.pixels[i].x - full.pixels[i].x, 2);
    return std::sqrt(sum / double(full.pixels.size()));
  };
  const MultiresSettings settings{.coarsest = 4, .light = 0.02f};
  const double shared = error(multires(gbuffer, lights, settings, GatherMode::Splat));
  const double own = error(multires(gbuffer, lights, settings, GatherMode::SplatPerVpl));
  EXPECT_GT(shared, 0.01);
  EXPECT_LT(own, 0.05 * shared);
}

/// Glossy light goes the same ways.
TEST_F(MultiresTest, GlossyLightIsGatheredSplattedAndUpsampledLikeTheRest) {
  const GBuffer gbuffer = glossyRoomSurfaces();
  ASSERT_NE(gbuffer.finish, nullptr);
  const std::vector<vec4> full = glossyTexels(gbuffer, GatherMode::Full, {});
  ASSERT_EQ(full.size(), 64u * 48);
  for (const GatherMode mode : {GatherMode::Multires, GatherMode::Splat, GatherMode::SplatPerVpl}) {
    const std::vector<vec4> each = glossyTexels(gbuffer, mode, {.coarsest = 4, .depth = 0});
    ASSERT_EQ(each.size(), full.size());
    for (size_t i = 0; i < full.size(); ++i) {
      ASSERT_GT(full[i].x, 0);
      ASSERT_NEAR(each[i].x, full[i].x, 2e-5f * full[i].x);
    }
  }
  const std::vector<vec4> patched = glossyTexels(gbuffer, GatherMode::Multires, {.coarsest = 4});
  float lo = kInfinity, hi = 0;
  for (const vec4& g : full) lo = std::min(lo, g.x), hi = std::max(hi, g.x);
  for (const vec4& g : patched) {
    ASSERT_GE(g.x, 0.9999f * lo);
    ASSERT_LE(g.x, 1.0001f * hi);
  }
}

/// α of paper 2, equation 2.
TEST_F(MultiresTest, SurfaceDetailDarkensWhatTurnsAway) {
  const GBuffer gbuffer = roomSurfaces();
  const Image plain = multires(gbuffer, roomLights(), {.coarsest = 4});
  const Image detailed = multires(gbuffer, roomLights(), {.coarsest = 4, .detail = 0.5f});
  const Image normal = surfaceBuffer(Buffer::Normal, gbuffer);
  for (const auto [x, y] : Pixels(plain)) {
    const CameraRay ray = pixelRay(room.scene.camera, x, y);
    const float facing = std::max(0.0f, -glm::dot(ray.direction, normal.at(x, y)));
    ASSERT_NEAR(detailed.at(x, y).y, plain.at(x, y).y * (0.5f * facing + 0.5f), 2e-3f * plain.at(x, y).y + 1e-6f);
  }
}

} // namespace lambent::test::multires_test
