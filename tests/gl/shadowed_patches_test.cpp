// Patches and splats of lights with shadow maps: light that a blocker stops is missing, all else is there.
#include "engine/core/rng.h"
#include "gi/visibility/paraboloid_maps.h"
#include "gl_fixture.h"

namespace lambent::test::shadowed_patches_test {

/// A floor below a roof over x > 0, and lights above its edge: half of them, at random, at x = −0.3 m, whose shadow
/// begins at x = 0.3 m, the others the other way round: a light that looked into another's map would be seen to.
/// The camera is below the roof.
class ShadowedPatchesTest : public GatherTest {
 protected:
  static constexpr int kLights = 40; // every class of 16 has two or three

  ShadowedPatchesTest() {
    const uint32_t grey = scene.material(vec3(0.5f));
    scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), grey);
    scene.box(vec3(0, 1, -10), vec3(10, 1.02f, 10), grey, false);
    scene.camera = cameraAt(vec3(0, 0.9f, 0), vec3(0), 1.0f, 128, 96);
    gbuffer = surfaces(scene);
  }
  static int side(int slot) { return int(mix64(uint64_t(slot)) & 1); }
  /// Slots of that side only (0 or 1), or all.
  static std::vector<VirtualLight> lights(int only = -1) {
    std::vector<VirtualLight> all;
    for (int i = 0; i < kLights; ++i) {
      all.push_back(lightAt(vec3(side(i) ? -0.3f : 0.3f, 2.02f, 0.01f * float(i)), vec3(0, -1, 0),
                            vec3(1 + 0.1f * float(i)), 0.05f));
      all.back().alive = only < 0 || side(i) == only;
    }
    return all;
  }
  ParaboloidMaps maps(const std::vector<VirtualLight>& of) {
    poses.clear();
    jobs.clear();
    for (const VirtualLight& light : of) {
      jobs.push_back({uint32_t(poses.size()), TexelRect::whole(256)});
      poses.push_back(light.pose(1e-4f));
    }
    return mapPass.run({.scene = placed->gpu(),
                        .poses = poses,
                        .jobs = jobs,
                        .farDistance = 30,
                        .resolution = 256,
                        .maker = ShadowMaker::Raster});
  }
  Image picture(const std::vector<VirtualLight>& of, const Settings& settings, const ParaboloidMaps* seen = nullptr) {
    return read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, of, settings, seen));
  }
  /// `blurred`: metres around a shadow's edge that a texel and a patch cover; `tolerance`: share of the light without
  /// shadows.
  void expectHalves(const Settings& settings, float blurred, float tolerance) {
    const ParaboloidMaps seen = maps(lights());
    const Image shadowed = picture(lights(), settings, &seen), right = picture(lights(0), settings),
                left = picture(lights(1), settings);
    int counts[3] = {};
    for (const auto [x, y] : Pixels(shadowed)) {
      const float at = -2 * 0.9f * std::tan(0.5f) / 96 * (63.5f - float(x)); // metres
      if (std::min(std::abs(at - 0.3f), std::abs(at + 0.3f)) < blurred) continue;
      const bool rightSeen = at < -0.3f, leftSeen = at < 0.3f;
      const float wanted = (rightSeen ? right.at(x, y).x : 0) + (leftSeen ? left.at(x, y).x : 0);
      ASSERT_NEAR(shadowed.at(x, y).x, wanted, tolerance * (right.at(x, y).x + left.at(x, y).x)) << at << " m, " << y;
      ++counts[int(rightSeen) + int(leftSeen)];
    }
    for (const int count : counts) EXPECT_GT(count, 1000);
  }

  HandScene scene;
  GBuffer gbuffer;
  ParaboloidMapPass mapPass{passes, StageId::VplMaps};
  std::vector<MapPose> poses;
  std::vector<MapJob> jobs;
};

TEST_F(ShadowedPatchesTest, HalvesAreLitByWhatSeesThem) {
  for (const GatherMode mode :
       {GatherMode::Full, GatherMode::Multires, GatherMode::MultiresInterleaved, GatherMode::Splat}) {
    SCOPED_TRACE(rowOf(mode).name);
    Settings settings = with(mode);
    settings.multires.coarsest = 32; // patches of 4 × 4 pixels, of 4 cm: lists do not follow the light
    expectHalves(settings, mode == GatherMode::Full ? 0.03f : 0.11f, 1e-3f);
  }
}

/// Large patches here, which each light splits where its shadow ends.
TEST_F(ShadowedPatchesTest, PatchesPerLightFollowItsShadow) {
  Settings settings = with(GatherMode::SplatPerVpl);
  settings.multires.coarsest = 4; // 32 × 32 pixels, 33 cm
  settings.multires.light = 0.02f;
  expectHalves(settings, 0.22f, 0.05f); // four points say whether a patch splits: an edge beyond them is missed
}

} // namespace lambent::test::shadowed_patches_test
