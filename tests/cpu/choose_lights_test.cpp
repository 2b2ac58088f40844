// Lights chosen for tiles: chances, and the expectation of lists.
#include "gi/lists/choose_lights.h"
#include "tests/support/hand_scene.h"

#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>

namespace lambent::test::choose_lights_test {

TEST(ChancesOf, SumToWhatIsWantedAndAreAtMostOne) {
  const std::vector<float> weights{100, 0, 1, 2, 3, 50, 0.001f, 4};
  std::vector<float> chances(weights.size());
  for (const float wanted : {1.0f, 2.5f, 4.0f, 6.0f}) {
    chancesOf(weights, wanted, chances);
    double sum = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
      EXPECT_LE(chances[i], 1) << wanted;
      EXPECT_EQ(chances[i] > 0, weights[i] > 0) << wanted;
      sum += double(chances[i]);
    }
    EXPECT_NEAR(sum, wanted, 1e-5);
    EXPECT_NEAR(chances[3], std::min(1.0f, 2 * chances[2]), 1e-6f) << "in proportion";
  }
  chancesOf(weights, 7, chances);
  for (size_t i = 0; i < weights.size(); ++i) EXPECT_EQ(chances[i], weights[i] > 0 ? 1 : 0);
  chancesOf(std::vector<float>(8, 0.0f), 3, chances);
  for (const float c : chances) EXPECT_EQ(c, 0);
}

/// A floor under a grid of lights that look down, brighter ones among them.
struct LitFloor {
  HandScene scene;
  std::vector<VirtualLight> lights;

  explicit LitFloor(size_t count) {
    scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, scene.material(vec3(0.5f)));
    scene.camera = cameraAt(vec3(0, 3, 0), vec3(0), 1.2f, 32, 32);
    for (size_t i = 0; i < count; ++i) {
      VirtualLight& l = lights.emplace_back();
      l.position = vec3(float(i % 50) * 0.15f - 3.7f, 1.0f, float(i / 50) * 0.15f - 3.7f);
      l.normal = l.geometricNormal = vec3(0, -1, 0);
      l.radiance = vec3(i % 97 == 0 ? 50 : 1);
      l.area = 0.01f;
      l.alive = i % 5 != 1;
    }
  }
  ListTable choose(int wanted, uint32_t sample) const {
    const TracedScene traced(scene);
    GatherSettings gather;
    gather.lights = wanted;
    uint64_t rays = 0;
    ListTable table;
    chooseLights({.view = traced.view, .rays = traced.rays, .lights = lights, .gather = gather, .sample = sample},
                 table, rays);
    return table;
  }
};

/// How often each light counts in the lists of a tile, mean over classes.
std::vector<double> countsOf(const ListTable& table, size_t tile, size_t lights) {
  std::vector<double> counts(lights, 0);
  const size_t list = size_t(table.chunks + table.length);
  for (size_t c = 0; c < kLightClasses; ++c) {
    const uint32_t* texels = table.texels.data() + tile * table.row() + c * list;
    uint32_t from = 0;
    for (size_t chunk = 0; chunk < size_t(table.chunks); ++chunk) {
      for (uint32_t i = from; i < texels[chunk]; ++i) {
        const uint32_t entry = texels[size_t(table.chunks) + i];
        counts[chunk * kLightsPerChunk + (entry & 0xffff)] +=
            double(glm::unpackHalf1x16(uint16_t(entry >> 16))) / kLightClasses;
      }
      EXPECT_LE(from, texels[chunk]);
      from = texels[chunk];
    }
    EXPECT_LE(from, uint32_t(table.length));
  }
  return counts;
}

/// The slots in the list of each class of a tile. Of one chunk.
std::vector<std::vector<uint32_t>> slotsOf(const ListTable& table, size_t tile) {
  EXPECT_EQ(table.chunks, 1);
  std::vector<std::vector<uint32_t>> slots(kLightClasses);
  for (size_t c = 0; c < kLightClasses; ++c) {
    const uint32_t* texels = table.texels.data() + tile * table.row() + c * size_t(1 + table.length);
    for (uint32_t i = 0; i < texels[0]; ++i) slots[c].push_back(texels[1 + i] & 0xffff);
  }
  return slots;
}

TEST(ChooseLights, EachCountsOnceOnTheMean) {
  for (const size_t count : {size_t(1000), size_t(5000)}) { // the second has three chunks
    const LitFloor floor(count);
    constexpr int kCycles = 200;
    std::vector<double> mean(count, 0), squares(count, 0);
    for (int cycle = 0; cycle < kCycles; ++cycle) {
      const std::vector<double> counts = countsOf(floor.choose(32, 16 * uint32_t(cycle)), 5, count);
      for (size_t i = 0; i < count; ++i) mean[i] += counts[i] / kCycles, squares[i] += counts[i] * counts[i] / kCycles;
    }
    double sum = 0, alive = 0;
    for (size_t i = 0; i < count; ++i) {
      if (!floor.lights[i].alive) {
        ASSERT_EQ(mean[i], 0) << i;
        continue;
      }
      // Rare ticks leave lights that count alike in all cycles, or of many lights never.
      const double error = std::sqrt(std::max(squares[i] - mean[i] * mean[i], 0.0) / kCycles);
      if (count == 1000) {
        ASSERT_NEAR(mean[i], 1, 6 * error + 0.03) << i;
      }
      sum += mean[i], ++alive;
    }
    EXPECT_NEAR(sum / alive, 1, 0.02) << count;
  }
}

TEST(ChooseLights, TheStrongestAreInEveryList) {
  const LitFloor floor(1000);
  const std::vector<double> counts = countsOf(floor.choose(64, 0), 5, 1000);
  size_t always = 0;
  for (size_t i = 0; i < counts.size(); ++i) always += counts[i] == 1;
  EXPECT_GT(always, 3u);
  EXPECT_LT(always, 64u);
}

/// Ticks go round: all lists are as long, none has a light twice, and what has 16 ticks is in each.
TEST(ChooseLights, ClassesTakeTurns) {
  const LitFloor floor(1000);
  const ListTable table = floor.choose(64, 0);
  for (size_t tile = 0; tile < 64; ++tile) {
    const std::vector<double> counts = countsOf(table, tile, 1000);
    size_t shortest = 1000, longest = 0, always = 0;
    std::vector<int> lists(1000, 0);
    for (const std::vector<uint32_t>& of : slotsOf(table, tile)) {
      shortest = std::min(shortest, of.size()), longest = std::max(longest, of.size());
      ASSERT_EQ(std::set(of.begin(), of.end()).size(), of.size()) << tile;
      for (const uint32_t slot : of) ++lists[slot];
    }
    EXPECT_GE(longest, 64u) << tile;
    EXPECT_LE(longest - shortest, 1u) << tile;
    for (size_t i = 0; i < 1000; ++i) always += counts[i] == 1 && lists[i] == kLightClasses;
    EXPECT_GT(always, 1u) << tile;
  }
}

/// For sixteen frames, in which every pixel sees the lists of all classes.
TEST(ChooseLights, ListsStayUntilAllClassesWereSeen) {
  const LitFloor floor(1000);
  const std::vector<uint32_t> first = floor.choose(32, 16).texels;
  for (const uint32_t sample : {17u, 20u, 31u}) EXPECT_EQ(floor.choose(32, sample).texels, first) << sample;
  for (const uint32_t sample : {0u, 15u, 32u}) EXPECT_NE(floor.choose(32, sample).texels, first) << sample;
}

/// Rows of tiles count from the bottom of the image.
TEST(ChooseLights, TilesTakeTheLightsThatStandOverThem) {
  LitFloor floor(0);
  const CameraView& camera = floor.scene.camera;
  constexpr int kTiles = 8; // along a side, of 4 pixels
  for (int t = 0; t < kTiles * kTiles; ++t) {
    const CameraRay ray =
        cameraRay(camera, (float(t % kTiles) + 0.5f) / kTiles, 1 - (float(t / kTiles) + 0.5f) / kTiles);
    VirtualLight& l = floor.lights.emplace_back();
    l.position = ray.origin - ray.direction * ((ray.origin.y - 0.1f) / ray.direction.y);
    l.normal = l.geometricNormal = vec3(0, -1, 0);
    l.radiance = vec3(1);
    l.area = 0.01f;
    l.alive = true;
  }
  const ListTable table = floor.choose(4, 0);
  ASSERT_EQ(table.tiles, glm::ivec2(kTiles));
  for (size_t t = 0; t < kTiles * kTiles; ++t)
    for (const std::vector<uint32_t>& of : slotsOf(table, t)) EXPECT_EQ(std::ranges::count(of, t), 1) << t;
}

TEST(ChooseLights, FewLightsAreAllTaken) {
  const LitFloor floor(50);
  const ListTable table = floor.choose(64, 0);
  for (size_t tile = 0; tile < 16; ++tile) {
    const std::vector<double> counts = countsOf(table, tile, 50);
    for (size_t i = 0; i < 50; ++i) ASSERT_EQ(counts[i], floor.lights[i].alive ? 1 : 0) << tile << ' ' << i;
  }
}

TEST(ChooseLights, RareLightsCountAFiniteNumberOfTimes) {
  const LitFloor floor(20000);
  for (uint32_t cycle = 0; cycle < 4; ++cycle) {
    const ListTable table = floor.choose(1, 16 * cycle);
    for (size_t tile = 0; tile < 16; ++tile)
      for (const double counts : countsOf(table, tile, 20000)) ASSERT_TRUE(std::isfinite(counts));
  }
}

TEST(ChooseLights, LargeImagesHaveLargerTiles) {
  LitFloor floor(50);
  floor.scene.size(1920, 1080);
  const ListTable table = floor.choose(64, 0);
  EXPECT_EQ(table.tile, 48);
  EXPECT_EQ(table.tiles, glm::ivec2(40, 23));
}

TEST(ChooseLights, LightsWithoutNumbersAreLeftOut) {
  LitFloor floor(200);
  floor.lights[7].radiance = vec3(std::numeric_limits<float>::quiet_NaN());
  floor.lights[8].radiance = vec3(kInfinity);
  const std::vector<double> counts = countsOf(floor.choose(256, 0), 0, 200);
  EXPECT_EQ(counts[7], 0);
  EXPECT_EQ(counts[8], 0);
  EXPECT_EQ(counts[9], 1);
}

/// A class has lights of other regions in each tile: else rows of pixels are stripes where a frame stands alone.
TEST(ChooseLights, TilesBeginWithOtherClasses) {
  const LitFloor floor(2000);
  const ListTable table = floor.choose(1, 0);
  std::set<size_t> begin; // classes that hold the lights at the corner where the curve begins
  for (size_t tile = 0; tile < 64; ++tile) {
    float least = kInfinity;
    size_t holds = 0;
    const std::vector<std::vector<uint32_t>> slots = slotsOf(table, tile);
    for (size_t c = 0; c < slots.size(); ++c)
      for (const uint32_t slot : slots[c]) {
        const vec3& p = floor.lights[slot].position;
        if (p.x + p.z >= least) continue;
        least = p.x + p.z;
        holds = c;
      }
    begin.insert(holds);
  }
  EXPECT_GT(begin.size(), 12u) << "of 16; with one turn for all tiles a few";
}

} // namespace lambent::test::choose_lights_test
