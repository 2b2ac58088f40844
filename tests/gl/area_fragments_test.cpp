// Area lights at patches: where these are split, by each rule, and how the picture is mixed from them (paper 4, 3.1.2
// to 3.1.5).
#include "area_lights.h"

namespace lambent::test::area_light_test {

TEST_F(AreaLightTest, TwoLevelsAtOnceAreTheSamePicture) {
  HandScene scene;
  scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), scene.material(vec3(0.5f)));
  scene.quad(vec3(0, 2, 0), vec3(0.1f, 0, 0), vec3(0, 0, 0.1f), scene.material(vec3(0), vec3(50)));
  scene.box({-5, 1, -5}, {0, 1.05f, 5}, scene.material(vec3(0.7f)), false); // half of the floor in its shadow
  scene.camera = cameraAt(vec3(0, 0.9f, 2), vec3(0, 0, 0), 1.0f, 192, 128);
  settings.area.refinement = AreaRefinement::SubFragments;
  settings.area.threshold = 1;
  settings.area.rays = 64;
  const Image gass = irradianceOf(scene);
  const uint64_t rays = stats.raysArea.occlusion;
  settings.area.gradient = 0;
  const Image one = irradianceOf(scene);
  EXPECT_LT(relativeRmse(gass, one), 0.01);
  std::printf("rays %llu, %llu level by level\n", (unsigned long long)rays,
              (unsigned long long)stats.raysArea.occlusion);
  EXPECT_GT(double(rays), 1.03 * double(stats.raysArea.occlusion)) << "steps are saved, rays are not";
  EXPECT_LT(double(rays), 1.13 * double(stats.raysArea.occlusion));
}

/// A half plane before a square lamp: the floor sees a sample of it where it stands right of a line, so it is known
/// which answers differ within a fragment, and around it. Each one is split where the rule says so, and only there;
/// GASS splits quarters twice where it says so. (Counts are held to what lies beside too: they may split more.)
TEST_F(AreaLightTest, FragmentsAreSplitWhereAHalfPlaneSaysSo) {
  constexpr int kSize = 256, kCoarsest = 4;
  constexpr float kEdge = 0.045f; // metres: on no border of fragments
  settings.area.extra = false;
  const int rays = settings.area.rays;
  const CameraView camera = cameraAt(vec3(0, 1.2f, 0.001f), vec3(0, 0, 0), 1.2f, kSize, kSize);
  AreaLights lights;
  /// Which of `count` rays from a pixel (rows from the bottom) are open; ray j goes to place u(j) among the samples.
  const auto openAt = [&](const glm::ivec2& pixel, int count, auto&& u) {
    const CameraRay ray = pixelRay(camera, pixel.x, kSize - 1 - pixel.y);
    const float x = (ray.origin - ray.direction * (ray.origin.y / ray.direction.y)).x;
    uint64_t bits = 0;
    for (int j = 0; j < count; ++j) {
      const AreaSample& to = lights.samples[uint32_t(u(j) * float(lights.lights[0].samples))];
      bits |= uint64_t(x + to.position.x > 2 * kEdge) << j; // what lies half way up is left or right of the edge
    }
    return bits;
  };
  struct Rule {
    const char* name;
    AreaRefinement refinement;
    int threshold, gradient;
    float lamp; // metres along a side
  };
  for (const Rule& rule : {Rule{"sub-fragments", AreaRefinement::SubFragments, 1, 0, 0.8f},
                           {"sub-fragments, small lamp", AreaRefinement::SubFragments, 1, 0, 0.08f},
                           {"and twice at once", AreaRefinement::SubFragments, 1, 4, 0.08f},
                           {"counts", AreaRefinement::Counts, 3, 0, 0.8f},
                           {"neighbours", AreaRefinement::Neighbours, 1, 0, 0.8f}}) {
    HandScene scene;
    const uint32_t white = scene.material(vec3(0.5f));
    scene.quad(vec3(-4, 0, 4), vec3(8, 0, 0), vec3(0, 0, -8), white);
    scene.quad(vec3(-0.5f * rule.lamp, 3, -0.5f * rule.lamp), vec3(rule.lamp, 0, 0), vec3(0, 0, rule.lamp),
               scene.material(vec3(0), vec3(5)));
    scene.quad(vec3(-9, 1.5f, -9), vec3(9 + kEdge, 0, 0), vec3(0, 0, 18), white); // half way up
    scene.camera = camera;
    lights = areaLights(collectLights(scene.view()));
    ASSERT_EQ(lights.lights.size(), 1u);
    settings.area.refinement = rule.refinement;
    settings.area.threshold = rule.threshold;
    settings.area.gradient = rule.gradient;
    irradianceOf(scene);
    const bool counts = rule.refinement == AreaRefinement::Counts;
    // As area_visibility.cpp aims: all quarters at the same samples, or each at its own.
    const auto quartersOf = [&](const glm::ivec2& texel, int level) {
      constexpr int kOwn[4] = {0, 2, 3, 1};
      const int side = 1 << level;
      std::array<uint64_t, 4> open{};
      for (int s = 0; s < 4; ++s)
        open[size_t(s)] = openAt(texel * side + side / 4 + side / 2 * glm::ivec2(s & 1, s >> 1), rays, [&](int j) {
          return counts ? (float(4 * j + kOwn[s]) + 0.5f) / float(4 * rays) : (float(j) + 0.5f) / float(rays);
        });
      return open;
    };
    const auto apart = [](uint64_t a, uint64_t b) { return std::abs(std::popcount(a) - std::popcount(b)); };
    const auto differs = [&](const glm::ivec2& texel, int level) {
      if (rule.refinement == AreaRefinement::Neighbours) { // 64 rays, from the middle of each of nine
        const auto middle = [&](const glm::ivec2& t) {
          return openAt(t * (1 << level) + (1 << level) / 2, 64, [](int j) { return (float(j) + 0.5f) / 64; });
        };
        for (int k = 0; k < 9; ++k) {
          const glm::ivec2 there = texel + glm::ivec2(k % 3 - 1, k / 3 - 1);
          if (glm::all(glm::greaterThanEqual(there, glm::ivec2(0))) &&
              glm::all(glm::lessThan(there, glm::ivec2(kSize >> level))) && middle(there) != middle(texel))
            return true;
        }
        return false;
      }
      const std::array<uint64_t, 4> open = quartersOf(texel, level);
      for (const auto& [i, j] : {std::pair(0, 1), {1, 3}, {3, 2}, {2, 0}})
        if (counts ? apart(open[size_t(i)], open[size_t(j)]) >= rule.threshold : open[size_t(i)] != open[size_t(j)])
          return true;
      return false;
    };
    /// Whether a fragment was split without a question, as GASS does for a quarter of the one around it.
    const auto forced = [&](const glm::ivec2& texel, int level) {
      if (rule.gradient == 0 || level < 1 || level >= kCoarsest) return false;
      const std::array<uint64_t, 4> open = quartersOf(texel / 2, level + 1);
      const size_t own = size_t((texel.x & 1) + 2 * (texel.y & 1));
      for (const size_t beside : {own ^ 1, own ^ 2})
        if (apart(open[own], open[beside]) > rule.gradient) return true;
      return false;
    };
    int kept = 0, split = 0, twice = 0, keptUnasked = 0, wrong = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const int level = levels[size_t((kSize - 1 - y) * kSize + x)];
        if (level < 0) continue;
        const int side = 1 << level;
        if (x % side || y % side) continue;
        const glm::ivec2 texel(x / side, y / side);
        if (level > 0) wrong += differs(texel, level), keptUnasked += forced(texel, level), ++kept;
        if (level == kCoarsest) continue;
        // It is there because the one around it was split.
        const bool unasked = forced(texel / 2, level + 1);
        if (!counts) wrong += !differs(texel / 2, level + 1) && !unasked;
        twice += unasked;
        ++split;
      }
    std::printf("%s: %d kept, %d of split ones, %d of those unasked (%d that were kept), %d elsewhere\n", rule.name,
                kept, split, twice, keptUnasked, wrong);
    EXPECT_GT(kept, 250) << rule.name;
    EXPECT_GT(split, 300) << rule.name;
    EXPECT_EQ(twice > 50, rule.gradient > 0) << rule.name;
    EXPECT_LT(wrong, (kept + split) / 100) << rule.name << ": a ray at the edge itself";
    EXPECT_LE(keptUnasked, twice / 20) << rule.name;
  }
}

/// A lamp that half of the picture does not see, though nothing tells of it there: pixels whose shares of the two lamps
/// differ ask the same samples all the same, so that nothing is split where nothing changes.
TEST_F(AreaLightTest, ThePredecessorComparesLikeRays) {
  LampScene scene;
  const uint32_t white = scene.material(vec3(0.7f));
  scene.quad(vec3(2, 1.5f, -0.3f), vec3(0.6f, 0, 0), vec3(0, 0, 0.6f), scene.material(vec3(0), vec3(6)));
  scene.box({1.8f, 0.4f, -4}, {1.9f, 1.8f, 4}, white, false); // the floor left of it does not see that lamp
  scene.size(192, 128);
  settings.area.refinement = AreaRefinement::Neighbours;
  settings.area.threshold = 1000;
  irradianceOf(scene);
  const std::vector<int> whole = levels;
  settings.area.threshold = 1;
  irradianceOf(scene);
  int left = 0, split = 0, elsewhere = 0;
  for (const auto [x, y] : Pixels(192, 128)) {
    const CameraRay ray = pixelRay(scene.camera, x, y);
    const vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
    if (ray.direction.y >= 0) continue;
    const size_t i = size_t(y * 192 + x);
    const bool hidden = at.x > -1.5f && at.x < 0.5f && std::abs(at.z) < 2;
    left += hidden;
    (hidden ? split : elsewhere) += levels[i] != whole[i];
  }
  EXPECT_GT(left, 2000);
  EXPECT_EQ(split, 0);
  EXPECT_GT(elsewhere, 500) << "its shadow's edge";
}

/// A plate, a pole, a fence and a block that reaches the lamp, above the floor.
struct ShadedLampScene : LampScene {
  explicit ShadedLampScene(int what) {
    const uint32_t white = material(vec3(0.7f));
    if (what == 0) box({-0.3f, 0.6f, -0.3f}, {0.3f, 0.7f, 0.3f}, white, false);
    if (what == 1) box({0.2f, 0, 0.2f}, {0.23f, 1.2f, 0.23f}, white, false);
    for (int i = 0; i < 8 && what == 2; ++i)
      box({-0.8f + 0.2f * float(i), 0, 0.3f}, {-0.74f + 0.2f * float(i), 0.7f, 0.33f}, white, false);
    if (what == 3) box({-1.2f, 0, -0.5f}, {-0.2f, 1.99f, 0.5f}, white, false);
    size(640, 426);
  }
};

/// Three single pixels on the borders of large fragments: in half shadows these then follow what lies between.
TEST_F(AreaLightTest, ExtraSamplesSteerLargeFragments) {
  settings.area.refinement = AreaRefinement::SubFragments;
  settings.area.threshold = 1;
  constexpr float kMost[4] = {1, 0.9f, 1.02f, 0.7f}; // of the error without, by obstacle
  double squares[2] = {};
  for (int what = 0; what < 4; ++what) {
    const ShadedLampScene scene(what);
    const Image traced = tracedOf(scene, 12, true);
    const AreaLights lights = areaLights(collectLights(scene.view()));
    double own[2] = {};
    int pixels = 0;
    std::vector<int> large; // fragments, without the single pixels in them
    for (const bool extra : {false, true}) {
      settings.area.extra = extra;
      const Image image = irradianceOf(scene);
      if (!extra) large = levels;
      for (const auto [x, y] : Pixels(640, 426)) {
        const CameraRay ray = pixelRay(scene.camera, x, y);
        const vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
        if (ray.direction.y >= 0 || large[size_t(y * 640 + x)] < 3) continue;
        const float whole = unshadowed(lights, lights.lights[0], at, vec3(0, 1, 0)).x,
                    share = traced.at(x, y).x / whole;
        if (!(share > 0.02f && share < 0.98f)) continue;
        const double off = double((image.at(x, y).x - traced.at(x, y).x) / whole);
        squares[extra] += off * off;
        own[extra] += off * off;
        ++pixels;
      }
    }
    std::printf("%d: RMSE of the share in half shadows %.2f of that without extra samples, %d pixels\n", what,
                std::sqrt(own[1] / own[0]), pixels / 2);
    EXPECT_LT(std::sqrt(own[1] / own[0]), kMost[what]) << what;
    EXPECT_GT(pixels / 2, 300) << what;
  }
  std::printf("all: %.3f of that without\n", std::sqrt(squares[1] / squares[0]));
  EXPECT_LT(std::sqrt(squares[1] / squares[0]), 0.7);
}

/// Half of the lamp is covered right below it: everywhere on the floor about as much is seen, and no sample stands out.
TEST_F(AreaLightTest, AnEvenHalfShadowStaysEven) {
  LampScene scene;
  scene.quad({-0.4f, 1.99f, -0.3f}, {0.4f, 0, 0}, {0, 0, 0.6f}, scene.material(vec3(0.5f)));
  settings.area.refinement = AreaRefinement::SubFragments;
  settings.area.threshold = 1;
  settings.area.upsample = AreaUpsample::Rbf;
  const Image fitted = irradianceOf(scene);
  settings.area.upsample = AreaUpsample::Bilinear;
  const Image bilinear = irradianceOf(scene);
  double got = 0, wanted = 0;
  for (const auto [x, y] : Pixels(fitted)) {
    const CameraRay ray = pixelRay(scene.camera, x, y);
    const vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
    if (ray.direction.y >= 0 || std::abs(at.x) > 1.5f || std::abs(at.z) > 1.5f) continue;
    got += double(fitted.at(x, y).x), wanted += double(bilinear.at(x, y).x);
  }
  std::printf("an even half shadow: %.5f of what its samples are\n", got / wanted);
  EXPECT_NEAR(got / wanted, 1, 4e-3) << "1.011 where the fit does not give a constant back";
}

TEST_F(AreaLightTest, FewerFragmentsThanThePredecessorAndUpsampledBetter) {
  LampScene scene;
  scene.box({-0.3f, 0.6f, -0.3f}, {0.3f, 0.7f, 0.3f}, scene.material(vec3(0.7f)), false);
  scene.size(384, 256);
  const Image traced = tracedOf(scene, 24, true), image = irradianceOf(scene);
  const double error = relativeRmse(image, traced);
  const uint64_t fragments = stats.areaFragments, rays = stats.raysArea.occlusion;
  EXPECT_NEAR(meanLuminance(image) / meanLuminance(traced), 1, 0.008) << "64 rays";
  EXPECT_LT(error, 0.0065);
  settings.area.refinement = AreaRefinement::SubFragments; // paper 4's own, with its extra samples
  settings.area.threshold = 1;
  settings.area.upsample = AreaUpsample::Rbf;
  const double papersError = relativeRmse(irradianceOf(scene), traced);
  const uint64_t papers = stats.areaFragments;
  settings.area.upsample = AreaUpsample::Bilinear;
  const double papersBilinear = relativeRmse(irradianceOf(scene), traced);
  settings.area.refinement = AreaRefinement::Neighbours;
  irradianceOf(scene);
  std::printf("fragments %llu, of paper 4 %llu, of its predecessor %llu\n", (unsigned long long)fragments,
              (unsigned long long)papers, (unsigned long long)stats.areaFragments);
  std::printf("RMSE %.5f, of paper 4 %.5f, bilinear %.5f\n", error, papersError, papersBilinear);
  EXPECT_GT(papersBilinear, 1.1 * papersError);
  EXPECT_LT(papersError, 0.022) << "0.038 where what lies between the middles of quarters is mixed too";
  EXPECT_GT(stats.areaFragments, fragments);
  EXPECT_LT(double(papers), 0.75 * double(stats.areaFragments)) << "0.53 is published";
  EXPECT_GT(2 * stats.raysArea.occlusion, 3 * rays)
      << "twice as many where fragments are not held to finer ones beside them";
  settings.multires.depth = 0; // every pixel asks all
  irradianceOf(scene);
  EXPECT_GT(stats.areaFragments, 384u * 256u / 2);
  EXPECT_GT(stats.raysArea.occlusion, 4 * rays);
}

} // namespace lambent::test::area_light_test
