// The reference and virtual lights are two ways to the same number: with exact areas and a ray for every pair, the
// gather must agree with it, clamped alike, or with what bounds take given back.
#include "gi/near/near_light.h"
#include "tests/support/reference.h"
#include "tests/support/spread_lights.h"

namespace lambent::test::gather_test {

constexpr int kBounces = 3;

struct LitBox : ReferenceBox {
  LitBox() {
    scene.quad({0.7f, 0.99f, 1}, {0.5f, 0, 0}, {0, 0, 0.5f}, scene.material(vec3(0), vec3(4))); // faces down
  }
};

/// A box with an emissive quad under its ceiling and a lamp in a corner.
struct Room : LitBox, TracedScene {
  RayCounts counts;

  Room() : TracedScene(LitBox::scene) {}

  /// Lights of equal areas, anywhere on the walls.
  std::vector<VirtualLight> spread(int count, uint32_t seed) {
    std::vector<Vpl> vpls = spreadOverBox(size, albedo, count, seed);
    relight(vpls, rays, lights, 16, kBounces);
    VplSet set;
    set.slots = std::move(vpls);
    return lightsOf(set);
  }

  /// Mean irradiance of the picture by the reference, and its standard error.
  Mean truth(float clamp, uint32_t samples) {
    const ReferenceImage picture =
        trace({rays, lights, view.camera, kBounces, clamp, 1}, samples, ReferenceBuffer::Irradiance);
    const double mean = meanOfPixels(picture.mean.pixels);
    return {mean, mean * picture.relativeErrorOfMean};
  }
  static double meanOfPixels(std::span<const vec3> pixels) {
    double sum = 0;
    for (const vec3& e : pixels) sum += double(e.y) / double(pixels.size());
    return sum;
  }
};

TEST(ReferenceAgainstVpls, ClampedGatherOfEvenlySpreadLights) {
  Room room;
  GatherSettings gather;
  gather.disk = 0;
  gather.clamp = 3; // 1/m²
  std::vector<double> means;
  for (uint32_t set = 0; set < 16; ++set)
    means.push_back(
        Room::meanOfPixels(gatherByRays(room.rays, room.view.camera, room.spread(2000, set), gather, room.counts)));
  const Mean truth = room.truth(gather.clamp, 1000);
  EXPECT_TRUE(agrees(meanOf(means), truth, 0.01 * truth.mean));
}

/// Few lights and wide bounds: a tenth of the light or more is near light, and all of it comes back.
TEST(ReferenceAgainstVpls, NearLightGivesBackWhatBoundsTake) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  Room room;
  const Mean truth = room.truth(0, 4000);
  for (const bool subsets : {false, true}) {
    GatherSettings gather;
    gather.disk = subsets ? 4 : 1;
    gather.clamp = subsets ? 0 : 2;
    gather.nearLimit = 0;
    std::vector<double> bounded, means;
    for (uint32_t set = 0; set < 400; ++set) {
      const std::vector<VirtualLight> lights = room.spread(150, set);
      bounded.push_back(Room::meanOfPixels(gatherByRays(room.rays, room.view.camera, lights, gather, room.counts)));
      const NearLight near = traceNearLight({.view = room.view,
                                             .rays = room.rays,
                                             .lights = room.lights,
                                             .virtuals = lights,
                                             .gather = gather,
                                             .bounces = kBounces,
                                             .subsets = subsets,
                                             .seed = set + 1,
                                             .frame = set / 2,
                                             .frames = set % 2 == 0 ? 1 : 64},
                                            room.counts);
      means.push_back(bounded.back() + Room::meanOfPixels(near.irradiance));
    }
    EXPECT_TRUE(agrees(meanOf(means), truth, 0.004 * truth.mean)) << "subsets " << subsets;
    EXPECT_LT(meanOf(bounded).mean, 0.9 * truth.mean) << "or there was little to give back";
  }
}

/// In motion rays go where near surfaces were found: expectations and budget stay.
TEST(ReferenceAgainstVpls, NearLightInMotionMeansTheSame) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  Room room;
  GatherSettings gather;
  gather.disk = 4;
  gather.nearLimit = 0;
  const std::vector<VirtualLight> lights = room.spread(150, 1);
  NearMemory memory;
  std::vector<double> stands, moves;
  uint64_t cast[2] = {};
  SceneView view = room.view; // sways
  for (uint32_t frame = 0; frame < 400; ++frame) {
    for (const bool moving : {false, true}) {
      RayCounts counts;
      const NearLight near = traceNearLight({.view = view,
                                             .rays = room.rays,
                                             .lights = room.lights,
                                             .virtuals = lights,
                                             .gather = gather,
                                             .casts = 32,
                                             .bounces = kBounces,
                                             .subsets = true,
                                             .seed = 1 + frame / 8,
                                             .frame = frame,
                                             .frames = 64,
                                             .memory = moving ? &memory : nullptr},
                                            counts);
      (moving ? moves : stands).push_back(Room::meanOfPixels(near.irradiance));
      cast[moving] += counts.closest;
    }
    view.camera.worldFromView[3].x += frame % 64 < 32 ? 0.002f : -0.002f;
  }
  const Mean expected = meanOf(stands);
  EXPECT_GT(expected.mean, 0);
  EXPECT_TRUE(agrees(meanOf(moves), expected, 0.01 * expected.mean));
  EXPECT_NEAR(double(cast[1]), double(cast[0]), 0.25 * double(cast[0])) << "more of them go on";
}

/// What a single ray brings does not stay in a few pixels.
TEST(ReferenceAgainstVpls, NearLightInMotionHasNoOutliers) {
  Room room;
  CameraView& camera = room.view.camera;
  camera.width = 96;
  camera.height = 72;
  GatherSettings gather;
  gather.disk = 4;
  const std::vector<VirtualLight> lights = room.spread(600, 1);
  NearMemory memory;
  size_t lit = 0, outliers = 0; // pixels
  for (uint32_t frame = 0; frame < 4; ++frame) {
    const std::vector<vec3> near = traceNearLight({.view = room.view,
                                                   .rays = room.rays,
                                                   .lights = room.lights,
                                                   .virtuals = lights,
                                                   .gather = gather,
                                                   .casts = 8,
                                                   .bounces = kBounces,
                                                   .subsets = true,
                                                   .frame = frame,
                                                   .frames = 64,
                                                   .memory = &memory},
                                                  room.counts)
                                       .irradiance;
    for (const auto [x, y] : Pixels({3, 3}, {camera.width - 3, camera.height - 3})) {
      const auto at = [&](int u, int v) { return luminance(near[size_t(v) * size_t(camera.width) + size_t(u)]); };
      float around = 0;
      for (const auto [u, v] : Pixels({x - 3, y - 3}, {x + 4, y + 4})) around += at(u, v) / 49;
      lit += at(x, y) > 0;
      outliers += at(x, y) > 8 * around;
    }
  }
  EXPECT_GT(lit, 1000);
  EXPECT_LT(double(outliers), 0.002 * double(lit)) << "0.004 where nothing is spread";
}

/// No ray brings more than the limit allows, and where the limit is out of reach nothing changes.
TEST(ReferenceAgainstVpls, NearLightKeepsToItsLimit) {
  Room room;
  const std::vector<VirtualLight> lights = room.spread(150, 1);
  float brightest = 0;
  for (const VirtualLight& light : lights) brightest = std::max(brightest, luminance(light.radiance));
  const auto traced = [&](float limit) {
    GatherSettings gather;
    gather.nearLimit = limit;
    const NearLightInputs in{.view = room.view,
                             .rays = room.rays,
                             .lights = room.lights,
                             .virtuals = lights,
                             .gather = gather,
                             .casts = 16,
                             .bounces = kBounces,
                             .subsets = true};
    return traceNearLight(in, room.counts).irradiance;
  };
  const std::vector<vec3> free = traced(0), far = traced(1e6f), limited = traced(0.5f);
  EXPECT_EQ(free, far);
  double lost = 0;
  for (size_t i = 0; i < free.size(); ++i) {
    EXPECT_LE(luminance(limited[i]), 1.0001f * kPi * 0.5f * brightest);
    EXPECT_LE(luminance(limited[i]), 1.0001f * luminance(free[i]));
    lost += luminance(free[i]) - luminance(limited[i]);
  }
  EXPECT_GT(lost, 0);
}

} // namespace lambent::test::gather_test
