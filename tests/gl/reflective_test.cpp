// Reflective shadow maps, their VPLs, clusters and trees: flux against closed forms and against one another.
#include "gi/reflective/reflective_maps.h"
#include "gl_fixture.h"
#include "shader_copy.h"
#include "shaders/shared/solid_angle.h"

namespace lambent::test::reflective_test {

constexpr ReflectiveNeeds kGrid, kTrees{.clusters = true}, kClusters{.clusters = true, .patches = true};

class ReflectiveTest : public GatherTest {
 protected:
  void place(const HandScene& scene) {
    placed = std::make_unique<PlacedScene>(passes, scene);
    bounds = scene.view().boundsWorld;
  }
  ReflectiveMaps maps(const std::vector<LightView>& lights, const RsmSettings& rsm, ReflectiveNeeds needs) {
    return mapPass.run({placed->gpu(), lights, bounds, false, {}, rsm, needs});
  }
  /// Sum over a mip level of a texture, double precision.
  static glm::dvec4 sum(const gl::Texture& texture, int level) {
    glm::dvec4 total(0);
    for (const vec4& t : texelsOf(texture, level)) total += glm::dvec4(t);
    return total;
  }
  static std::vector<vec4> texelsOf(const gl::Texture& texture, int level) {
    std::vector<vec4> texels(size_t(texture.width() >> level) * size_t(texture.height() >> level));
    texture.read(std::span(texels), GL_RGBA, GL_FLOAT, level);
    return texels;
  }
  /// A closed room of 2 m.
  void placeBox(const vec3& albedo) {
    HandScene scene;
    scene.box(vec3(-1), vec3(1), scene.material(albedo), true);
    place(scene);
  }
  /// Of the point light of (1, 2, 3) W/sr in a box of albedo (½, ¼, 1), all of whose flux is reflected.
  static void expectAllReflected(const glm::dvec3& flux) {
    const double sphere = 4 * double(kPi);
    EXPECT_NEAR(flux.x, 0.5 * sphere, double(byHalfFloats(1e-4f, 5e-4f)) * flux.x);
    EXPECT_NEAR(flux.y, 0.25 * 2 * sphere, double(byHalfFloats(1e-4f, 5e-4f)) * flux.y);
    EXPECT_NEAR(flux.z, 3 * sphere, double(byHalfFloats(1e-4f, 5e-4f)) * flux.z);
  }
  glm::dvec3 fluxOfLights() const {
    glm::dvec3 total(0);
    for (const VplLight& light : lightPass.read()) total += glm::dvec3(vec3(light.powerNormalX)) * double(kPi);
    return total;
  }
  PackedLights lightsOf(const ReflectiveMaps& sheet, const RsmSettings& rsm, ReflectiveNeeds needs) {
    return needs.clusters ? lightPass.runClusters(sheet, rsm) : lightPass.runGrid(sheet, rsm);
  }
  Image gathered(const HandScene& scene, const ReflectiveMaps& sheet, const RsmSettings& rsm, ReflectiveNeeds needs,
                 GatherMode mode = GatherMode::Full) {
    const GBuffer gbuffer = surfacePass.run({placed->gpu(), scene.camera});
    const LightTrees trees{sheet, rsm};
    VirtualLights lights;
    if (needs == kTrees)
      lights.trees = &trees;
    else
      lights.packed = lightsOf(sheet, rsm, needs);
    return read(Buffer::Unfiltered, gbuffer, GatherTest::gathered(gbuffer, lights, with(mode)));
  }

  Room room;
  Aabb bounds;
  ReflectiveMapPass mapPass{passes};
  ReflectiveLightPass lightPass{passes};
};

/// Gathers from trees with shaders that draw their work in place of light: how often a fragment turned.
class TurnCounter {
 public:
  struct Turns {
    int whole = 0;                 // of one pixel, over all draws
    bool tooManyInOneDraw = false; // more than 4096
  };
  explicit TurnCounter(gl::GpuProfiler& profiler) : gathers_{PassContext{programs_, profiler}} {
    shaders_.replace("tree_gather.frag", "while (m < end) {", "while (m < end) {\n      ++turns;");
    shaders_.replace("tree_gather.frag", "for (int root", "int turns = 0;\n  for (int root");
    shaders_.replace("tree_gather.frag", "vec4(irradiance * float(rootStep), 1.0)",
                     "vec4(turns > 4096 ? 1.0 : 0.0, float(turns), 0.0, 1.0)");
  }
  std::vector<Turns> count(const World& world, const GBuffer& gbuffer, const LightTrees& trees) {
    Settings settings;
    settings.gather.mode = GatherMode::Full;
    Patches none;
    FrameStats stats;
    const SurfaceLighting light = gathers_.run(world, gbuffer, none, {{.trees = &trees}}, settings, stats);
    std::vector<Turns> turns;
    for (const vec4& texel : readTexture(*light.irradiance)) turns.push_back({int(texel.y), texel.x > 0});
    return turns;
  }

 private:
  ShaderCopy shaders_;
  gl::ProgramCache programs_{shaders_.path};
  Gathers gathers_;
};

LightView pointLight(const vec3& position, const vec3& intensity) {
  return {.position = position, .intensity = intensity};
}

LightView spotLight(const vec3& position, const vec3& direction) {
  LightView light = pointLight(position, vec3(3, 2, 1));
  light.type = LightType::Spot;
  light.direction = glm::normalize(direction);
  light.innerConeCos = 0.8f;
  light.outerConeCos = 0.70710678f;
  return light;
}

LightView sunLight(float irradiance) {
  return {
      .type = LightType::Directional, .direction = glm::normalize(vec3(0.3f, -1, 0.2f)), .intensity = vec3(irradiance)};
}

TEST(SolidAngle, TexelsOfAFaceAddUpToASixthOfTheSphere) {
  for (const int resolution : {1, 4, 16, 256}) {
    double total = 0;
    const float texel = 2.0f / float(resolution);
    for (const auto [x, y] : Pixels(resolution, resolution)) {
      const vec2 lo = vec2(x, y) * texel - 1.0f;
      total += rectSolidAngle(lo, lo + texel);
    }
    EXPECT_NEAR(total, 4 * double(kPi) / 6, 2e-6) << resolution;
  }
}

TEST_F(ReflectiveTest, APointLightInAClosedRoomReflectsAllItsFlux) {
  placeBox(vec3(0.5f, 0.25f, 1));
  for (const bool exact : {true, false}) {
    const RsmSettings rsm{.resolution = 64, .exact = exact};
    const ReflectiveMaps sheet = maps({pointLight(vec3(0.3f, -0.2f, 0.1f), vec3(1, 2, 3))}, rsm, kTrees);
    expectAllReflected(
        glm::dvec3(sum(*sheet.flux, 0))); // walls share no vertices: a texel or two may fall between them
  }
}

/// What an eye looks through light does not.
TEST_F(ReflectiveTest, HiddenBacksReflectAsAll) {
  HandScene scene;
  const uint32_t wall = scene.material(vec3(0.5f, 0.25f, 1));
  scene.assets.materials[wall].backHidden = true;
  scene.box(vec3(-1), vec3(1), wall, false);
  place(scene);
  const RsmSettings rsm{.resolution = 64};
  const ReflectiveMaps sheet = maps({pointLight(vec3(0.3f, -0.2f, 0.1f), vec3(1, 2, 3))}, rsm, kTrees);
  expectAllReflected(glm::dvec3(sum(*sheet.flux, 0)));
}

TEST_F(ReflectiveTest, ASpotReflectsWhatItsConeLetsThrough) {
  placeBox(vec3(0.5f));
  const LightView spot = spotLight(vec3(0.1f, 0.3f, -0.2f), vec3(0.2f, -1, 0.4f));
  const ReflectiveMaps sheet = maps({spot}, {.resolution = 256}, kGrid);
  // glTF: the square of what falls from 1 at the inner cone to 0 at the outer, linear in the cosine.
  const double inner = double(spot.innerConeCos), outer = double(spot.outerConeCos);
  const double cone = 2 * double(kPi) * ((1 - inner) + (inner - outer) / 3);
  EXPECT_NEAR(sum(*sheet.flux, 0).x, 0.5 * double(spot.intensity.x) * cone, 1e-3 * cone);
}

TEST(LightGrid, HardlyFewerVplsThanAskedFor) {
  for (int maps = 1; maps <= 40; ++maps)
    for (int vpls = maps; vpls <= 3000; ++vpls) {
      const LightGrid grid = lightGrid(vpls, maps);
      ASSERT_LE(grid.count(), vpls) << maps;
      ASSERT_GE(grid.count(), vpls - std::sqrt(double(vpls) / maps) - 1) << maps << ' ' << vpls;
      ASSERT_LT(grid.mapsWithOneMore, maps);
      ASSERT_GE(grid.rows, 1);
      ASSERT_LE(std::max(grid.rows, grid.columns), 2 * std::min(grid.rows + 1, grid.columns) + 1)
          << maps << ' ' << vpls;
    }
  EXPECT_EQ(lightGrid(256, 1).columns, 16);
  EXPECT_EQ(lightGrid(256, 1).rows, 16);
  EXPECT_GE(lightGrid(256, 6).count(), 250);
  EXPECT_EQ(lightGrid(2, 6).count(), 6) << "no map is left out";
  EXPECT_EQ(lightGrid(256, 0).count(), 0);
}

/// Cells of unlike sizes, whose light is that of one texel times what they have of its solid angle.
TEST_F(ReflectiveTest, AnyNumberOfVplsCarriesAllFlux) {
  placeBox(vec3(0.5f, 0.25f, 1));
  for (const bool exact : {true, false})
    for (const int vpls : {6, 20, 256, 300, 1024}) {
      const RsmSettings rsm{.resolution = 256, .vpls = vpls, .exact = exact};
      const ReflectiveMaps sheet = maps({pointLight(vec3(0.01f, -0.02f, 0.03f), vec3(1, 2, 3))}, rsm, kGrid);
      const PackedLights lights = lightPass.runGrid(sheet, rsm);
      EXPECT_LE(int(lights.count), vpls);
      EXPECT_GE(int(lights.count), vpls - 8);
      SCOPED_TRACE(vpls);
      expectAllReflected(fluxOfLights());
    }
}

TEST_F(ReflectiveTest, ASunReflectsWhatFallsOnThePlane) {
  HandScene scene;
  scene.quad(vec3(-1, 0, 2), vec3(2, 0, 0), vec3(0, 0, -4), scene.material(vec3(0.5f)));
  place(scene);
  const LightView sun = sunLight(10);
  const ReflectiveMaps sheet = maps({sun}, {.resolution = 512}, kGrid);
  // 8 m² across the light's way; the map counts whole texels along the edge.
  EXPECT_NEAR(sum(*sheet.flux, 0).x, 0.5 * 10 * 8 * double(-sun.direction.y), 0.3);
}

TEST_F(ReflectiveTest, ClustersAndTreesKeepFluxAndArea) {
  place(room.scene);
  const std::vector<LightView> lights{sunLight(4), pointLight(vec3(0.3f, 0.5f, 0.4f), vec3(1, 2, 3)),
                                      spotLight(vec3(-0.4f, 0.8f, 0.5f), vec3(0.2f, -1, -0.5f))};
  const RsmSettings rsm{.resolution = 128, .coarsest = 8, .finest = 64};
  const ReflectiveMaps sheet = maps(lights, rsm, kClusters);
  ASSERT_EQ(sheet.maps.size(), 8u);
  const glm::dvec4 flux = sum(*sheet.flux, 0);
  for (int level = 1; level < sheet.levels; ++level) {
    const glm::dvec4 clusters = sum(*sheet.flux, level);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(clusters[c], flux[c], 1e-5 * flux[c]) << level;
  }
  const PackedLights vpls = lightPass.runClusters(sheet, rsm);
  EXPECT_LT(vpls.count, 8u * 64 * 64 / 4) << "smooth patches are one VPL";
  EXPECT_GT(vpls.count, 8u * 64) << "steps are not";
  const glm::dvec3 ofLights = fluxOfLights();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ofLights[c], flux[c], 1e-5 * flux[c]);
}

/// Where a cluster's light seems to come from.
TEST_F(ReflectiveTest, ClustersStandInTheMiddleOfTheirFlux) {
  placeBox(vec3(0.5f));
  const ReflectiveMaps sheet =
      maps({pointLight(vec3(0.8f, 0.3f, -0.6f), vec3(1))}, {.resolution = 16, .coarsest = 2}, kTrees);

  const std::vector<vec4> positions = texelsOf(*sheet.position, 0), fluxes = texelsOf(*sheet.flux, 0),
                          means = texelsOf(*sheet.position, 1);
  const size_t width = size_t(sheet.flux->width());
  double unweighted = 0;
  for (size_t i = 0; i < means.size(); ++i) {
    const size_t first = i / (width / 2) * 2 * width + i % (width / 2) * 2;
    vec3 sum(0), plain(0);
    float flux = 0;
    for (const size_t k : {first, first + 1, first + width, first + width + 1}) {
      sum += fluxes[k].x * vec3(positions[k]);
      plain += 0.25f * vec3(positions[k]);
      flux += fluxes[k].x;
    }
    ASSERT_GT(flux, 0);
    ASSERT_LT(glm::distance(vec3(means[i]), sum / flux), 1e-5f) << i;
    unweighted = std::max(unweighted, double(glm::distance(plain, sum / flux)));
  }
  EXPECT_GT(unweighted, 1e-3) << "or the weights say nothing";
}

/// Clusters around a corner face neither wall, and their mean normal is short. As long as it is, it would lose light.
TEST_F(ReflectiveTest, CoarseClustersLoseNoLight) {
  place(room.scene);
  const RsmSettings fine{.resolution = 64, .coarsest = 4, .finest = 64, .tau = 1e-6f};
  RsmSettings coarse = fine;
  coarse.tau = 0.02f;
  const ReflectiveMaps sheet = maps({pointLight(vec3(0.3f, 0.6f, 0.2f), vec3(1))}, fine, kTrees);
  const auto mean = [&](const RsmSettings& rsm) { return meanLuminance(gathered(room.scene, sheet, rsm, kTrees)); };
  const double all = mean(fine);
  EXPECT_NEAR(mean(coarse) / all, 1, 0.013); // 1.008; of short normals 0.982
}

TEST_F(ReflectiveTest, AGridWaitsForNothingAndClustersOnce) {
  place(room.scene);
  std::vector<LightView> lights{pointLight(vec3(0.3f, 0.5f, 0.4f), vec3(1, 2, 3))};
  const RsmSettings rsm{.resolution = 32};
  const auto waitsOf = [&](ReflectiveNeeds needs) {
    const gl::Counts before = gl::counts();
    lightsOf(maps(lights, rsm, needs), rsm, needs);
    EXPECT_EQ((gl::counts() - before).readBacks, 0u);
    return (gl::counts() - before).waits;
  };
  EXPECT_EQ(waitsOf(kGrid), 0u);
  EXPECT_EQ(waitsOf(kClusters), 1u);
  EXPECT_EQ(waitsOf(kClusters), 0u) << "nothing changed";
}

/// A lit square on a black floor: what reflects nothing is no VPL.
TEST_F(ReflectiveTest, DarkClustersAreNoVpls) {
  HandScene scene;
  scene.quad(vec3(-2, 0, 2), vec3(4, 0, 0), vec3(0, 0, -4), scene.material(vec3(0)));
  scene.quad(vec3(-0.5f, 0.001f, 0.5f), vec3(1, 0, 0), vec3(0, 0, -1), scene.material(vec3(0.5f)));
  place(scene);
  const std::vector<LightView> lights{spotLight(vec3(0, 2, 0), vec3(0, -1, 0))};
  for (const float depth : {0.0f, 0.05f}) {
    const RsmSettings rsm{.resolution = 64, .coarsest = 8, .finest = 64, .depth = depth};
    const ReflectiveMaps sheet = maps(lights, rsm, kClusters);
    const glm::dvec4 flux = sum(*sheet.flux, 0);
    const PackedLights vpls = lightPass.runClusters(sheet, rsm);
    EXPECT_GT(vpls.count, 0u);
    EXPECT_LT(vpls.count, depth == 0 ? 300u : 20u); // a sixteenth of the map's 4096 texels, or of its 64 patches
    for (const VplLight& light : lightPass.read()) {
      ASSERT_GT(light.positionArea.w, 0);
      ASSERT_GT(light.powerNormalX.x, 0);
    }
    EXPECT_NEAR(fluxOfLights().x, flux.x, 1e-5 * flux.x);
  }
}

/// Every texel a light: grid, finest clusters and whole tree are the same sum.
TEST_F(ReflectiveTest, AllTexelsAreTheSameLightWhicheverWay) {
  place(room.scene);
  const std::vector<LightView> lights{pointLight(vec3(0.3f, 0.5f, 0.4f), vec3(1, 2, 3))};
  const RsmSettings rsm{
      .resolution = 32, .vpls = 6 * 32 * 32, .coarsest = 8, .finest = 32, .depth = 0, .normal = 0, .tau = 0};
  const Image grid = gathered(room.scene, maps(lights, rsm, kGrid), rsm, kGrid);
  const Image clusters = gathered(room.scene, maps(lights, rsm, kClusters), rsm, kClusters);
  const Image tree = gathered(room.scene, maps(lights, rsm, kTrees), rsm, kTrees);
  for (size_t i = 0; i < grid.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const float wanted = grid.pixels[i][c];
      ASSERT_GT(wanted, 0);
      ASSERT_NEAR(clusters.pixels[i][c], wanted, 1e-4f * wanted) << c;
      ASSERT_NEAR(tree.pixels[i][c], wanted, 1e-4f * wanted) << c;
    }
  }
}

/// Larger τ takes coarser clusters: less work, more error. At 0 every cluster is looked at that holds anything, at 1
/// the coarsest alone, at every pixel.
TEST_F(ReflectiveTest, TheCutFollowsTau) {
  place(room.scene);
  const GBuffer gbuffer = surfacePass.run({placed->gpu(), room.scene.camera});
  TurnCounter counter(profiler);
  RsmSettings rsm{.resolution = 64, .coarsest = 4, .finest = 64, .tau = 0};
  constexpr int kRoots = 4 * 4, kNodes = 1 + 4 + 16 + 64 + 256; // of a tree
  const ReflectiveMaps sheet = maps({spotLight(vec3(-0.2f, 0.9f, 0.5f), vec3(0.1f, -1, -0.4f))}, rsm, kTrees);
  std::vector<TurnCounter::Turns> before;
  Image whole;
  double errorBefore = 0;
  for (const float tau : {0.0f, 0.001f, 0.01f, 0.1f, 1.0f}) {
    rsm.tau = tau;
    const std::vector<TurnCounter::Turns> turns = counter.count(placed->world(), gbuffer, {sheet, rsm});
    double sum = 0, sumBefore = 0;
    for (size_t i = 0; i < turns.size(); ++i) {
      const int most = tau == 1 ? kRoots : tau > 0 ? before[i].whole : kRoots * kNodes;
      ASSERT_LE(turns[i].whole, most) << "τ " << tau << ", pixel " << i;
      ASSERT_GE(turns[i].whole, tau == 0 ? kRoots * kNodes : kRoots) << "τ " << tau << ", pixel " << i;
      sum += turns[i].whole;
      sumBefore += tau > 0 ? before[i].whole : 0;
    }
    const Image image = gathered(room.scene, sheet, rsm, kTrees);
    if (tau == 0) whole = image;
    double error = 0;
    for (size_t i = 0; i < whole.pixels.size(); ++i)
      error += std::abs(double(image.pixels[i].x) - double(whole.pixels[i].x));
    if (tau > 0) {
      EXPECT_GT(error, errorBefore) << tau;
      // Clusters are refined within a distance² in proportion to 1/τ; near the smallest τ that is all of the room.
      EXPECT_LT(sum, (tau < 0.01f ? 0.7 : 0.25) * sumBefore) << tau;
    }
    before = turns;
    errorBefore = error;
  }
}

/// Where a light or the camera moves by a centimetre, some clusters come to be refined and some no longer are. One of
/// them brings its exitance times τ at most, and its parts about as much, so no pixel's error jumps by more.
TEST_F(ReflectiveTest, ASmallMoveChangesTheCutByLittle) {
  place(room.scene);
  constexpr float kTau = RsmSettings{}.tau;
  RsmSettings rsm{.resolution = 64, .coarsest = 8, .finest = 64};
  for (const bool camera : {false, true}) {
    Image before;
    double changes = 0, light = 0;
    for (int step = 0; step <= 4; ++step) {
      const vec3 moved(0.01f * float(step), 0, 0);
      room.scene.camera =
          cameraAt(vec3(0.1f, 0.1f, 0.95f) + (camera ? moved : vec3(0)), vec3(0, -0.1f, -1), 1.4f, 32, 24);
      const vec3 lamp = vec3(-0.2f, 0.9f, 0.5f) + (camera ? vec3(0) : moved);
      rsm.tau = kTau;
      const ReflectiveMaps sheet = maps({spotLight(lamp, vec3(0.1f, -1, -0.4f))}, rsm, kTrees);
      Image error = gathered(room.scene, sheet, rsm, kTrees);
      rsm.tau = 0;
      const Image whole = gathered(room.scene, sheet, rsm, kTrees);
      double exitance = 0; // the largest
      for (const vec4& t : texelsOf(*sheet.flux, 0))
        if (t.a > 0) exitance = std::max(exitance, double(t.x) / double(t.a));
      double largest = 0, sum = 0;
      for (size_t i = 0; i < whole.pixels.size(); ++i) {
        error.pixels[i] -= whole.pixels[i];
        if (step == 0) continue;
        const double change = std::abs(double(error.pixels[i].x) - double(before.pixels[i].x));
        largest = std::max(largest, change);
        sum += change;
        light += whole.pixels[i].x;
      }
      changes += sum;
      EXPECT_LT(largest, double(kTau) * exitance) << "step " << step << (camera ? " of the camera" : " of the light");
      before = error;
    }
    EXPECT_GT(changes, 0) << "or the cut is the same everywhere";
    EXPECT_LT(changes, (camera ? 0.0003 : 0.004) * light);
  }
}

/// A spot over a dark floor with one bright cluster, which a ceiling faces from many distances. Where the picture is
/// the one of coarsest clusters, the cluster was not refined, and its contribution (paper 3, eq. 6) must be below τ.
TEST_F(ReflectiveTest, AClusterThatIsNotRefinedBringsLessThanTau) {
  const float height = 2, tangent = std::tan(1.1f); // 63°: texels at the middle have four times the mean solid angle
  LightView spot = spotLight(vec3(0, height, 0), vec3(0, -1, 0));
  spot.outerConeCos = std::cos(1.1f);
  spot.innerConeCos = std::cos(1.0f);
  RsmSettings rsm{.resolution = 64, .coarsest = 8, .finest = 64};
  const float side = 2 * tangent * height / 8; // of a cluster on the floor
  for (const glm::ivec2 cluster : {glm::ivec2(4, 4), glm::ivec2(5, 3), glm::ivec2(6, 5)}) {
    const float x = (float(cluster.x) - 4) * side, z = (float(cluster.y) - 4) * side, margin = 0.01f * side;
    double largest = 0;
    for (const float ceiling : {2.5f, 4.0f, 6.0f, 9.0f, 14.0f}) {
      HandScene scene;
      scene.quad(vec3(-30, 0, 30), vec3(60, 0, 0), vec3(0, 0, -60), scene.material(vec3(0)));
      scene.quad(vec3(x + margin, 0.001f, z + side - margin), vec3(side - 2 * margin, 0, 0),
                 vec3(0, 0, -side + 2 * margin), scene.material(vec3(1)));
      scene.quad(vec3(-30, ceiling, -30), vec3(60, 0, 0), vec3(0, 0, 60), scene.material(vec3(0.5f)));
      scene.camera = cameraAt(vec3(x + 0.5f * side, 0.5f * ceiling, z + 0.5f * side),
                              vec3(x + 0.5f * side, ceiling, z + 0.5f * side), 1.0f, 32, 24);
      place(scene);
      rsm.finest = 8;
      const Image coarse = gathered(scene, maps({spot}, rsm, kTrees), rsm, kTrees);
      rsm.finest = 64;
      for (const float tau : {0.001f, 0.003f, 0.01f, 0.03f}) {
        rsm.tau = tau;
        const ReflectiveMaps sheet = maps({spot}, rsm, kTrees);
        const glm::dvec4 cell = sum(*sheet.flux, sheet.levels - 1); // nothing else shines, but all has area
        const vec4 bright = std::ranges::max(texelsOf(*sheet.flux, sheet.levels - 1), {}, &vec4::x);
        ASSERT_GT(bright.x, 0.97 * cell.x) << "the bright square is one cluster";
        const Image cut = gathered(scene, sheet, rsm, kTrees);
        for (size_t i = 0; i < cut.pixels.size(); ++i) {
          // One alone may be the same by chance, where the sum over the parts passes the whole.
          if (cut.pixels[i] != coarse.pixels[i] || cut.pixels[i ^ 1] != coarse.pixels[i ^ 1]) continue;
          const double share = double(cut.pixels[i].x) * double(bright.a) / double(bright.x); // A cos cos/(π r² + A)
          ASSERT_LE(share, 1.001 * double(tau)) << cluster.x << ' ' << cluster.y << ", " << ceiling << " m";
          largest = std::max(largest, share / double(tau));
        }
      }
    }
    EXPECT_GT(largest, 0.5) << "or nothing near the bound was looked at";
  }
}

/// However deep the trees: draws that begin and end within one bring the same light.
TEST_F(ReflectiveTest, TreesInPartsAreTheSameLight) {
  room.scene.camera = cameraAt(vec3(0.1f, 0.1f, 0.95f), vec3(0, -0.1f, -1), 1.4f, 16, 12);
  place(room.scene);
  const std::vector<LightView> lights{spotLight(vec3(-0.2f, 0.9f, 0.5f), vec3(0.1f, -1, -0.4f))};
  const GBuffer gbuffer = surfacePass.run({placed->gpu(), room.scene.camera});
  for (const GatherMode mode : {GatherMode::Full, GatherMode::Interleaved})
    for (const int coarsest : {1, 2, 16})
      for (const float tau : {0.0f, 0.003f, 0.05f}) {
        const RsmSettings rsm{.resolution = 64, .coarsest = coarsest, .finest = 64, .tau = tau};
        const ReflectiveMaps sheet = maps(lights, rsm, kTrees);
        Image whole;
        for (const int mostTurns : {30000, 4096, 100, 22}) {
          const LightTrees trees{sheet, rsm, mostTurns};
          const VirtualLights cut{.trees = &trees};
          const Image image = read(Buffer::Unfiltered, gbuffer, GatherTest::gathered(gbuffer, cut, with(mode)));
          if (mostTurns == 30000) whole = image;
          for (size_t i = 0; i < image.pixels.size(); ++i)
            ASSERT_NEAR(image.pixels[i].x, whole.pixels[i].x, 1e-5f * whole.pixels[i].x)
                << coarsest << ' ' << mostTurns << ' ' << tau;
        }
      }
}

TEST_F(ReflectiveTest, NoFragmentTurnsForLong) {
  TurnCounter counter(profiler);
  room.scene.camera = cameraAt(vec3(0.1f, 0.1f, 0.95f), vec3(0, -0.1f, -1), 1.4f, 8, 6);
  place(room.scene);
  const GBuffer gbuffer = surfacePass.run({placed->gpu(), room.scene.camera});
  for (const glm::ivec2 levels :
       {glm::ivec2(32, 256), glm::ivec2(1, 256)}) { // as by default; one tree that is too deep
    const RsmSettings rsm{.coarsest = levels.x, .finest = levels.y, .tau = 0};
    const ReflectiveMaps sheet = maps({spotLight(vec3(-0.2f, 0.9f, 0.5f), vec3(0.1f, -1, -0.4f))}, rsm, kTrees);
    for (const TurnCounter::Turns& turns : counter.count(placed->world(), gbuffer, {sheet, rsm})) {
      ASSERT_FALSE(turns.tooManyInOneDraw);
      ASSERT_GE(turns.whole, 256 * 256);
    }
  }
}

TEST_F(ReflectiveTest, OneReflectedPatchOnAPlane) {
  // A spot over a small bright square in a dark floor; a wall sees the square.
  HandScene scene;
  scene.quad(vec3(-5, 0, 5), vec3(10, 0, 0), vec3(0, 0, -10), scene.material(vec3(0)));
  scene.quad(vec3(-0.05f, 0.001f, 0.05f), vec3(0.1f, 0, 0), vec3(0, 0, -0.1f), scene.material(vec3(1)));
  scene.quad(vec3(-5, 0, -2), vec3(10, 0, 0), vec3(0, 4, 0), scene.material(vec3(0.5f)));
  scene.camera = cameraAt(vec3(0, 1.5f, 2), vec3(0, 1.5f, -2), 0.5f, 16, 12);
  place(scene);
  LightView spot = spotLight(vec3(0, 2, 0), vec3(0, -1, 0));
  spot.outerConeCos = std::cos(0.2f);
  spot.innerConeCos = std::cos(0.1f);
  const RsmSettings rsm{.resolution = 1024, .coarsest = 32, .finest = 256, .tau = 0};
  const Image image = gathered(scene, maps({spot}, rsm, kTrees), rsm, kTrees);
  const double flux = 3 * 0.01 / (1.999 * 1.999); // I ω of the square
  for (const auto [x, y] : Pixels(16, 12)) {
    const CameraRay ray = pixelRay(scene.camera, x, y);
    const vec3 at = ray.origin + ray.direction * ((-2 - ray.origin.z) / ray.direction.z);
    const double r2 = glm::dot(at, at);
    const double wanted = flux / double(kPi) * (at.y / std::sqrt(r2)) * (2 / std::sqrt(r2)) / r2; // paper 2, eq. 1
    ASSERT_NEAR(image.at(x, y).x, wanted, 0.02 * wanted) << x << ' ' << y;
  }
}

/// Each of the 16 subsets of pixels takes every sixteenth root, so that blocks of 4 × 4 pixels have them all.
TEST_F(ReflectiveTest, SubsetsOfPixelsShareTheTree) {
  HandScene scene;
  scene.quad(vec3(-5, 0, 5), vec3(10, 0, 0), vec3(0, 0, -10), scene.material(vec3(0.5f)));
  scene.quad(vec3(-5, 4, -5), vec3(10, 0, 0), vec3(0, 0, 10), scene.material(vec3(0.5f)));
  scene.camera = cameraAt(vec3(0, 2, 0), vec3(0, 0, 0), 0.1f, 32, 24); // light hardly changes over the picture
  place(scene);
  const RsmSettings rsm{.resolution = 64, .coarsest = 16, .finest = 64};
  const ReflectiveMaps sheet = maps({pointLight(vec3(0, 2, 0), vec3(1))}, rsm, kTrees);
  const Image full = gathered(scene, sheet, rsm, kTrees);
  const Image subsets = gathered(scene, sheet, rsm, kTrees, GatherMode::Interleaved);
  int apart = 0; // pixels that saw a part
  for (const auto [bx, by] : Pixels(8, 6)) {
    double sum = 0, wanted = 0;
    for (int k = 0; k < 16; ++k) {
      const float one = subsets.at(4 * bx + k % 4, 4 * by + k / 4).x, all = full.at(4 * bx + k % 4, 4 * by + k / 4).x;
      sum += double(one);
      wanted += double(all);
      apart += std::abs(one - all) > 0.05f * all;
    }
    ASSERT_NEAR(sum, wanted, 0.01 * wanted) << bx << ' ' << by;
  }
  EXPECT_GT(apart, 32 * 24 / 3);
}

TEST_F(ReflectiveTest, OnlyWhatChangedIsDrawn) {
  place(room.scene);
  std::vector<LightView> lights{pointLight(vec3(0.3f, 0.5f, 0.4f), vec3(1)),
                                spotLight(vec3(0, 0.9f, 0), vec3(0, -1, 0.1f))};
  const RsmSettings rsm{.resolution = 32};
  EXPECT_TRUE(maps(lights, rsm, kClusters).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 7u);
  EXPECT_FALSE(maps(lights, rsm, kClusters).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 0u);
  lights[0].intensity = vec3(2); // the same surfaces in another light
  const double before = sum(*maps({lights[1]}, rsm, kClusters).flux, 0).x;
  EXPECT_GT(before, 0);
  maps(lights, rsm, kClusters);
  lights[0].intensity = vec3(4);
  EXPECT_TRUE(maps(lights, rsm, kClusters).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 0u);
  lights[1].position.x += 0.1f;
  EXPECT_TRUE(maps(lights, rsm, kClusters).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 1u);
  const Aabb above{vec3(0.2f, 0.8f, 0.3f), vec3(0.4f, 0.9f, 0.5f)}; // what moved is above the point light
  EXPECT_TRUE(mapPass.run({placed->gpu(), lights, bounds, false, {&above, 1}, rsm, kClusters}).changed);
  EXPECT_GT(mapPass.mapsDrawn(), 0u);
  EXPECT_LT(mapPass.mapsDrawn(), 7u);
}

} // namespace lambent::test::reflective_test
