// Hemicubes: what the GPU draws is what rays meet.
#include "gi/cube/draw/hemicube_pass.h"

#include "frames.h"
#include "gi/cube/layered_cube.h"
#include "gi/vpl/sources.h"
#include "shader_copy.h"
#include "tests/support/random_world.h"

namespace lambent::test::hemicube_test {

class HemicubeTest : public GlTest {
 protected:
  /// How the texels of two makers compare.
  struct Agreement {
    size_t texels = 0, apart = 0; // of these, other surfaces than rays meet
    size_t astray = 0;            // of these, what no ray meets that passes near the texel's middle
    double share() const { return double(apart) / double(texels); }
  };

  /// Both makers' hemicubes of every light.
  void compare(const World& world, std::span<const VirtualLight> lights, int resolution, Agreement& sum) {
    compare(passes, world, lights, resolution, sum);
  }
  void compare(const PassContext& context, const World& world, std::span<const VirtualLight> lights, int resolution,
               Agreement& sum) {
    HemicubePass pass(context);
    std::vector<Hemicube> drawn, cast;
    for (const VirtualLight& light : lights) drawn.push_back(hemicubeAt(light, resolution, world.rays.rayEpsilon()));
    cast = drawn;
    pass.prepare(world, CubeMaker::Raster);
    pass.make(drawn);
    pass.prepare(world, CubeMaker::Rays);
    pass.make(cast);
    for (size_t i = 0; i < drawn.size(); ++i) compare(world.rays, drawn[i], cast[i], sum);
  }

  /// But for edges that pass a texel's middle; some of these are of slivers that no ray happens to find.
  static void expectAlike(const Agreement& sum) {
    std::printf("%zu texels: %.4f %% apart, %.4f %% astray\n", sum.texels, 100 * sum.share(),
                100 * double(sum.astray) / double(sum.texels));
    EXPECT_GT(sum.texels, 10000u);
    EXPECT_LT(sum.share(), 1e-3);
    EXPECT_LT(double(sum.astray), 1e-4 * double(sum.texels));
  }

  static void compare(const RayQuery& rays, const Hemicube& drawn, const Hemicube& cast, Agreement& sum) {
    for (int face = 0; face < 5; ++face)
      for (const auto [x, y] : Pixels(cast.resolution, cast.rows(face))) {
        ++sum.texels;
        const HemicubeTexel& is = drawn.at(face, x, y);
        const vec2 middle = vec2(x, y) + 0.5f;
        const vec3 direction = drawn.direction(face, middle);
        if (same(is, direction, cast.at(face, x, y), direction, rays.rayEpsilon())) continue;
        ++sum.apart;
        sum.astray += !metBeside(rays, drawn, face, middle, is);
      }
  }

  /// Whether two texels show one surface; each with the direction that it looks in.
  static bool same(const HemicubeTexel& a, const vec3& directionA, const HemicubeTexel& b, const vec3& directionB,
                   float rayEpsilon) {
    if (!(a.distance < kInfinity) || !(b.distance < kInfinity)) return a.distance == b.distance;
    const float off = std::abs(glm::dot(b.normal, a.distance * directionA - b.distance * directionB));
    return off < 2 * rayEpsilon + 1e-5f * b.distance && glm::dot(a.normal, b.normal) > 1 - 1e-4f &&
           glm::dot(a.normal, directionA) < 1e-3f;
  }

  /// A GPU rounds corners of triangles to 1/256 of a texel.
  static bool metBeside(const RayQuery& rays, const Hemicube& hemicube, int face, const vec2& middle,
                        const HemicubeTexel& texel) {
    constexpr float kAside = 1.0f / 64;
    for (int v = -2; v <= 2; ++v)
      for (int u = -2; u <= 2; ++u) {
        const vec3 direction = hemicube.direction(face, middle + 0.5f * kAside * vec2(u, v));
        const SurfaceHit hit = rays.closest(Ray{hemicube.origin, direction});
        const HemicubeTexel met = hit.valid() ? HemicubeTexel{hit.t, hit.geometricNormal} : HemicubeTexel{};
        if (same(texel, hemicube.direction(face, middle), met, direction, rays.rayEpsilon())) return true;
      }
    return false;
  }

  /// Lights that photons leave in a world.
  static std::vector<VirtualLight> photonLights(const SceneView& view, const RayQuery& rays, int count) {
    const SmcSettings settings{.vpls = count, .bounces = 2};
    const LightSet lights = collectLights(view);
    VplSet set;
    VplUpdateLog log;
    placeVpls(VplSource::Ir, set, {view, rays, lights, settings, 5}, log);
    std::vector<VirtualLight> alive;
    for (const VirtualLight& light : lightsOf(set))
      if (light.alive) alive.push_back(light);
    return alive;
  }
};

TEST_F(HemicubeTest, DrawnOnesSeeWhatRaysMeetInARoom) {
  const Room room;
  PlacedScene placed(passes, room.scene);
  const vec3 tilted = glm::normalize(vec3(0.2f, 1, -0.3f));
  std::vector<VirtualLight> lights = {
      lightAt({0.5f, -1, 0.3f}, {0, 1, 0}, vec3(1), 0.01f), lightAt({-1, 0.2f, 0.1f}, {1, 0, 0}, vec3(1), 0.01f),
      lightAt({1, 0, 0.5f}, {-1, 0, 0}, vec3(1), 0.01f),    lightAt({0.1f, 1, 0}, {0, -1, 0}, vec3(1), 0.01f),
      lightAt({0.2f, 0.3f, -1}, {0, 0, 1}, vec3(1), 0.01f), lightAt({-0.2f, 0.2f, -0.3f}, {0, 1, 0}, vec3(1), 0.01f),
      lightAt({0.5f, -1, 0.3f}, tilted, vec3(1), 0.01f)};
  lights.back().geometricNormal = {0, 1, 0};
  for (const int resolution : {32, 64, 128}) {
    Agreement sum;
    compare(placed.world(), lights, resolution, sum);
    expectAlike(sum);
  }
}

/// What lies between rounded corners lies beside the middles of texels (rounded_corners_test.cpp).
TEST_F(HemicubeTest, RoundedCornersLeaveDistances) {
  const RoundedCorners rounding;
  gl::ProgramCache rounded(rounding.path);
  const PassContext context{rounded, profiler};
  const Room room;
  PlacedScene placed(context, room.scene);
  const std::vector<VirtualLight> lights = {lightAt({0.5f, -1, 0.3f}, {0, 1, 0}, vec3(1), 0.01f),
                                            lightAt({-1, 0.2f, 0.1f}, {1, 0, 0}, vec3(1), 0.01f)};
  Agreement sum;
  compare(context, placed.world(), lights, 64, sum);
  expectAlike(sum);
}

TEST_F(HemicubeTest, DrawnOnesSeeWhatRaysMeetWhileAnythingMoves) {
  RandomWorld world(0.01f);
  GpuScene gpu(passes, world.assets());
  const LightSet none;
  Agreement sum;
  for (int frame = 0; frame < 4; ++frame) {
    const SceneView& view = world.step(frame == 0 ? 60 : 6);
    gpu.place(view.instances);
    const World now{view, gpu, world.rays(), kNothingMoved, none, view.boundsWorld.diameter()};
    compare(now, photonLights(view, world.rays(), 24), 64, sum);
  }
  expectAlike(sum);
}

/// A mask, seen from near and from far, on objects that are turned, mirrored and bent.
TEST_F(HemicubeTest, MasksAreCutOutAsRaysDo) {
  HandScene scene;
  std::vector<u8vec4> texels;
  for (uint32_t i = 0; i < 32 * 32; ++i) {
    Rng random(7, Stream::Test, i);
    texels.push_back({255, 255, 255, uint8_t(random.next() < 0.4f ? 0 : 255)});
  }
  const uint32_t white = scene.material(vec3(0.5f)), leaves = scene.material(vec3(0.5f));
  Material& m = scene.assets.materials[leaves];
  m.alphaMode = AlphaMode::Mask;
  m.baseColorTexture = scene.texture(32, texels);
  m.baseColorTexture.nearest = false;
  scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, white); // under the sky
  scene.quad({-4, 0, -4}, {0, 4, 0}, {0, 0, 8}, white);
  scene.assets.meshes.push_back(sheet(8, leaves));
  const uint32_t mesh = uint32_t(scene.assets.meshes.size() - 1);
  for (int i = 0; i < 8; ++i) {
    const mat4 turned = glm::rotate(mat4(1), float(i), glm::normalize(vec3(1, i, 2)));
    const vec3 at(3 * std::cos(float(i)), 0.7f + 0.4f * float(i), 3 * std::sin(float(i)));
    const uint32_t made =
        scene.instance(mesh, glm::translate(mat4(1), at) * turned * glm::scale(mat4(1), {i % 2 ? -1 : 1, 0.8f, 1}));
    if (i >= 6) scene.reshape(made, waves(scene.assets.meshes[mesh], 0.2f, float(i)));
  }
  PlacedScene placed(passes, scene);
  const std::vector<VirtualLight> lights = {lightAt({0, 0, 0}, {0, 1, 0}, vec3(1), 0.01f),
                                            lightAt({2, 0, 0.5f}, {0, 1, 0}, vec3(1), 0.01f),
                                            lightAt({-4, 2, 1}, {1, 0, 0}, vec3(1), 0.01f)};
  Agreement sum;
  compare(placed.world(), lights, 64, sum);
  expectAlike(sum);
}

/// A plate that lies nearly on the light hides all that is above it.
TEST_F(HemicubeTest, NothingIsTooNear) {
  for (const float gap : {1e-2f, 1e-3f, 1e-4f}) {
    HandScene scene;
    const uint32_t white = scene.material(vec3(0.5f));
    scene.box(vec3(-4, 0, -4), vec3(4, 4, 4), white, true);
    scene.box(vec3(-1, gap, -1), vec3(1, 1, 1), white, false);
    scene.box(vec3(1, 0, -1), vec3(1 + gap, 1, 1), white, false); // a slit beside it
    PlacedScene placed(passes, scene);
    const std::vector<VirtualLight> lights = {lightAt({0.1f, 0, 0.2f}, {0, 1, 0}, vec3(1), 0.01f),
                                              lightAt({1 - gap, 0, 0.2f}, {0, 1, 0}, vec3(1), 0.01f),
                                              lightAt({-1, 0.4f, 0}, {-1, 0, 0}, vec3(1), 0.01f)};
    Agreement sum;
    compare(placed.world(), lights, 64, sum);
    expectAlike(sum);
  }
}

TEST_F(HemicubeTest, ACubeOfDrawnOnesIsThatOfCastOnes) {
  RandomWorld world(0.01f);
  const SceneView& view = world.step(20);
  GpuScene gpu(passes, world.assets());
  gpu.place(view.instances);
  const LightSet none;
  const World now{view, gpu, world.rays(), kNothingMoved, none, view.boundsWorld.diameter()};
  const std::vector<VirtualLight> lights = photonLights(view, world.rays(), 96);
  const CubeSettings settings{.resolution = 32, .visibility = CubeVisibility::Hemicubes, .hemicube = 64};
  const GatherSettings gather;
  HemicubePass pass(passes);
  pass.prepare(now, CubeMaker::Raster);
  LayeredCube drawn, cast;
  // Hemicubes of two resolutions in one batch.
  CubeInputs in{view.boundsWorld, world.rays(), kNothingMoved, false, lights, 48, settings, gather};
  const CubeWork byRays = cast.update(in);
  in.hemicubes = &pass;
  const CubeWork byGpu = drawn.update(in);
  EXPECT_LT(byGpu.rays.closest + byGpu.rays.occlusion, byRays.rays.closest + byRays.rays.occlusion);
  double difference = 0, sum = 0;
  for (size_t e = 0; e < cast.surfaces().entries().size(); ++e) {
    difference += luminance(glm::abs(drawn.irradiance(e) - cast.irradiance(e)));
    sum += luminance(cast.irradiance(e));
  }
  std::printf("mean difference of entries: %.2g %%\n", 100 * difference / sum);
  EXPECT_GT(sum, 0);
  EXPECT_LT(difference, 0.001 * sum);
}

class HemicubeFrameTest : public HemicubeTest {
 protected:
  HemicubeFrameTest() {
    room.scene.lamp({0.3f, 0.6f, 0.4f}, vec3(2));
    applyTechnique(settings, "ibrr");
    settings.smc = {.vpls = 128, .bounces = 2};
    settings.cube = {.resolution = 32, .visibility = CubeVisibility::Hemicubes, .hemicube = 32};
    settings.gather.near = 0;
  }
  struct Result {
    Image light;
    FrameStats stats;
  };
  Result run(CubeMaker maker) {
    settings.hemicubes.maker = maker;
    Viewer gi(settings, 1, Makers::Measured);
    const FrameStats& stats = gi.run(room.scene.view());
    return {gi.read(Buffer::Irradiance), stats};
  }

  Room room;
  Settings settings;
};

TEST_F(HemicubeFrameTest, AFrameSaysWhoMadeThem) {
  const Result drawn = run(CubeMaker::Raster), cast = run(CubeMaker::Rays), measured = run(CubeMaker::Auto);
  EXPECT_EQ(drawn.stats.cubeMaker, "raster");
  EXPECT_EQ(cast.stats.cubeMaker, "rays");
  EXPECT_GT(drawn.stats.ms(StageId::Hemicubes), 0);
  EXPECT_EQ(cast.stats.ms(StageId::Hemicubes), 0);
  EXPECT_LT(drawn.stats.raysCube.closest, cast.stats.raysCube.closest);
  const double difference = relativeDifference(drawn.light, cast.light);
  std::printf("mean difference of pixels: %.2g %%\n", 100 * difference);
  EXPECT_LT(difference, 0.001);
  EXPECT_NE(measured.stats.cubeMakerTimes.find("ms a hemicube"), std::string::npos) << measured.stats.cubeMakerTimes;
  EXPECT_EQ(measured.stats.cubeMakerTimes.find(measured.stats.cubeMaker), 0u);
  EXPECT_EQ(measured.light.pixels, measured.stats.cubeMaker == "rays" ? cast.light.pixels : drawn.light.pixels);
  settings.cube.visibility = CubeVisibility::Rays;
  EXPECT_EQ(run(CubeMaker::Auto).stats.cubeMaker, "") << "there are none";
}

/// Both are measured once; who makes them may be changed while frames run, and the cube stays.
TEST_F(HemicubeFrameTest, AutoMeasuresBothMakersOnce) {
  Viewer gi(settings, 1, Makers::Measured);
  const std::string report = gi.run(room.scene.view()).cubeMakerTimes;
  room.scene.lights[0].position.x = -0.3f;
  const FrameStats& stats = gi.run(room.scene.view(kLightsChanged));
  EXPECT_GT(stats.ms(StageId::Cube), 0);
  EXPECT_EQ(stats.cubeMakerTimes, report);
  gi.settings().hemicubes.maker = CubeMaker::Raster;
  EXPECT_EQ(gi.run(room.scene.view(kStill)).ms(StageId::Hemicubes), 0);
  room.scene.lights[0].position.x = -0.2f;
  EXPECT_GT(gi.run(room.scene.view(kLightsChanged)).ms(StageId::Hemicubes), 0);
  EXPECT_EQ(gi.run(room.scene.view(kLightsChanged)).cubeMaker, "raster");
}

} // namespace lambent::test::hemicube_test
