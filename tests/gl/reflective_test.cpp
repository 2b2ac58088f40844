// Reflective shadow maps, their VPLs, clusters and trees: flux against closed forms and against one another.
#include "gi/lights/reflective_maps.h"
#include "gl_fixture.h"
#include "shaders/shared/solid_angle.h"

namespace lambent::test {

class ReflectiveTest : public GatherTest {
 protected:
  void place(const HandScene& scene) {
    placed = std::make_unique<PlacedScene>(programs, scene);
    bounds = scene.view().boundsWorld;
  }
  ReflectiveMaps maps(const std::vector<LightView>& lights, const RsmSettings& rsm, VplSource source) {
    return mapPass.run({placed->gpu(), lights, bounds, false, {}, rsm, source});
  }
  /// Sum over a mip level of a texture, double precision.
  static glm::dvec4 sum(const gl::Texture& texture, int level) {
    std::vector<vec4> texels(size_t(texture.width() >> level) * (texture.height() >> level));
    glGetTextureImage(texture.name(), level, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(vec4)), texels.data());
    glm::dvec4 total(0);
    for (const vec4& t : texels) total += glm::dvec4(t);
    return total;
  }
  glm::dvec3 fluxOfLights() const {
    glm::dvec3 total(0);
    for (const VplLight& light : lightPass.read()) total += glm::dvec3(vec3(light.powerNormalX)) * double(kPi);
    return total;
  }
  Image gathered(const HandScene& scene, const ReflectiveMaps& sheet, const RsmSettings& rsm, VplSource source,
                 GatherMode mode = GatherMode::Full) {
    const GBuffer gbuffer = surfacePass.run({placed->gpu(), scene.camera});
    const LightTrees trees{sheet, rsm};
    VirtualLights lights;
    if (source == VplSource::Hisr)
      lights.trees = &trees;
    else
      lights.packed = lightPass.run(sheet, rsm, source);
    return read(Buffer::Unfiltered, gbuffer, GatherTest::gathered(gbuffer, lights, with(mode)));
  }

  Aabb bounds;
  ReflectiveMapPass mapPass{passes};
  ReflectiveLightPass lightPass{passes};
};

LightView pointLight(const vec3& position, const vec3& intensity) {
  LightView light;
  light.position = position;
  light.intensity = intensity;
  return light;
}

LightView spotLight(const vec3& position, const vec3& direction) {
  LightView light = pointLight(position, vec3(3, 2, 1));
  light.type = LightType::Spot;
  light.direction = glm::normalize(direction);
  light.innerConeCos = 0.8f;
  light.outerConeCos = 0.70710678f;
  return light;
}

TEST(SolidAngle, TexelsOfAFaceAddUpToASixthOfTheSphere) {
  for (const int resolution : {1, 4, 16, 256}) {
    double total = 0;
    const float texel = 2.0f / float(resolution);
    for (int y = 0; y < resolution; ++y)
      for (int x = 0; x < resolution; ++x) {
        const vec2 lo = vec2(x, y) * texel - 1.0f;
        total += rectSolidAngle(lo, lo + texel);
      }
    EXPECT_NEAR(total, 4 * double(kPi) / 6, 2e-6) << resolution;
  }
}

TEST_F(ReflectiveTest, APointLightInAClosedRoomReflectsAllItsFlux) {
  HandScene scene;
  scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f, 0.25f, 1)), true);
  place(scene);
  for (const bool exact : {true, false}) {
    const RsmSettings rsm{.resolution = 64, .exact = exact};
    const ReflectiveMaps sheet = maps({pointLight(vec3(0.3f, -0.2f, 0.1f), vec3(1, 2, 3))}, rsm, VplSource::Hisr);
    const glm::dvec3 flux(sum(*sheet.flux, 0));
    const double sphere = 4 * double(kPi);
    // The walls share no vertices, so a texel or two of 24 576 may fall between them.
    EXPECT_NEAR(flux.x, 0.5 * sphere, 1e-4 * flux.x);
    EXPECT_NEAR(flux.y, 0.25 * 2 * sphere, 1e-4 * flux.y);
    EXPECT_NEAR(flux.z, 3 * sphere, 1e-4 * flux.z);
  }
}

TEST_F(ReflectiveTest, ASunReflectsWhatFallsOnThePlane) {
  HandScene scene;
  scene.quad(vec3(-1, 0, 2), vec3(2, 0, 0), vec3(0, 0, -4), scene.material(vec3(0.5f)));
  place(scene);
  LightView sun;
  sun.type = LightType::Directional;
  sun.direction = glm::normalize(vec3(0.3f, -1, 0.2f));
  sun.intensity = vec3(10);
  const ReflectiveMaps sheet = maps({sun}, {.resolution = 512}, VplSource::Rsm);
  // 8 m² across the light's way; the map counts whole texels along the edge.
  EXPECT_NEAR(sum(*sheet.flux, 0).x, 0.5 * 10 * 8 * double(-sun.direction.y), 0.3);
}

TEST_F(ReflectiveTest, ClustersAndTreesKeepFluxAndArea) {
  const Room room;
  place(room.scene);
  LightView sun;
  sun.type = LightType::Directional;
  sun.direction = glm::normalize(vec3(0.3f, -1, 0.2f));
  sun.intensity = vec3(4);
  const std::vector<LightView> lights{sun, pointLight(vec3(0.3f, 0.5f, 0.4f), vec3(1, 2, 3)),
                                      spotLight(vec3(-0.4f, 0.8f, 0.5f), vec3(0.2f, -1, -0.5f))};
  const RsmSettings rsm{.resolution = 128, .coarsest = 8, .finest = 64};
  const ReflectiveMaps sheet = maps(lights, rsm, VplSource::Isr);
  ASSERT_EQ(sheet.maps.size(), 8u);
  const glm::dvec4 flux = sum(*sheet.flux, 0);
  for (int level = 1; level < sheet.levels; ++level) {
    const glm::dvec4 clusters = sum(*sheet.flux, level);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(clusters[c], flux[c], 1e-5 * flux[c]) << level;
  }
  const PackedLights vpls = lightPass.run(sheet, rsm, VplSource::Isr);
  EXPECT_LT(vpls.count, 8u * 64 * 64 / 4) << "smooth patches are one VPL";
  EXPECT_GT(vpls.count, 8u * 64) << "steps are not";
  const glm::dvec3 ofLights = fluxOfLights();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ofLights[c], flux[c], 1e-5 * flux[c]);
}

/// Every texel a light: grid, finest clusters and whole tree are the same sum.
TEST_F(ReflectiveTest, AllTexelsAreTheSameLightWhicheverWay) {
  const Room room;
  place(room.scene);
  const std::vector<LightView> lights{pointLight(vec3(0.3f, 0.5f, 0.4f), vec3(1, 2, 3))};
  const RsmSettings rsm{
      .resolution = 32, .vpls = 6 * 32 * 32, .coarsest = 8, .finest = 32, .depth = 0, .normal = 0, .tau = 0};
  const Image grid = gathered(room.scene, maps(lights, rsm, VplSource::Rsm), rsm, VplSource::Rsm);
  const Image clusters = gathered(room.scene, maps(lights, rsm, VplSource::Isr), rsm, VplSource::Isr);
  const Image tree = gathered(room.scene, maps(lights, rsm, VplSource::Hisr), rsm, VplSource::Hisr);
  for (size_t i = 0; i < grid.pixels.size(); ++i) {
    ASSERT_GT(grid.pixels[i].x, 0);
    ASSERT_NEAR(clusters.pixels[i].x, grid.pixels[i].x, 1e-4f * grid.pixels[i].x);
    ASSERT_NEAR(tree.pixels[i].x, grid.pixels[i].x, 1e-4f * grid.pixels[i].x);
  }
}

/// Larger τ takes coarser clusters: less work, more error; the coarsest alone is what remains.
TEST_F(ReflectiveTest, TheCutFollowsTau) {
  const Room room;
  place(room.scene);
  const std::vector<LightView> lights{spotLight(vec3(-0.2f, 0.9f, 0.5f), vec3(0.1f, -1, -0.4f))};
  RsmSettings rsm{.resolution = 64, .coarsest = 4, .finest = 64, .tau = 0};
  const auto draw = [&](float tau) {
    rsm.tau = tau;
    return gathered(room.scene, maps(lights, rsm, VplSource::Hisr), rsm, VplSource::Hisr);
  };
  const Image whole = draw(0);
  double before = 0;
  for (const float tau : {0.001f, 0.01f, 0.1f, 1.0f}) {
    const Image image = draw(tau);
    double error = 0;
    for (size_t i = 0; i < whole.pixels.size(); ++i)
      error += std::abs(double(image.pixels[i].x) - double(whole.pixels[i].x));
    EXPECT_GT(error, before) << tau;
    before = error;
  }
  rsm.finest = 4;
  const Image coarsest = gathered(room.scene, maps(lights, rsm, VplSource::Hisr), rsm, VplSource::Hisr);
  EXPECT_EQ(coarsest.pixels, draw(1).pixels);
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
  const Image image = gathered(scene, maps({spot}, rsm, VplSource::Hisr), rsm, VplSource::Hisr);
  const double flux = 3 * 0.01 / (1.999 * 1.999); // I ω of the square
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x) {
      const CameraRay ray = cameraRay(scene.camera, (float(x) + 0.5f) / 16, (float(y) + 0.5f) / 12);
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
  const ReflectiveMaps sheet = maps({pointLight(vec3(0, 2, 0), vec3(1))}, rsm, VplSource::Hisr);
  const Image full = gathered(scene, sheet, rsm, VplSource::Hisr);
  const Image subsets = gathered(scene, sheet, rsm, VplSource::Hisr, GatherMode::Interleaved);
  for (int by = 0; by < 6; ++by)
    for (int bx = 0; bx < 8; ++bx) {
      double sum = 0, wanted = 0;
      for (int k = 0; k < 16; ++k) {
        sum += subsets.at(4 * bx + k % 4, 4 * by + k / 4).x;
        wanted += full.at(4 * bx + k % 4, 4 * by + k / 4).x;
      }
      ASSERT_NEAR(sum, wanted, 0.02 * wanted) << bx << ' ' << by;
    }
}

TEST_F(ReflectiveTest, OnlyWhatChangedIsDrawn) {
  const Room room;
  place(room.scene);
  std::vector<LightView> lights{pointLight(vec3(0.3f, 0.5f, 0.4f), vec3(1)),
                                spotLight(vec3(0, 0.9f, 0), vec3(0, -1, 0.1f))};
  const RsmSettings rsm{.resolution = 32};
  EXPECT_TRUE(maps(lights, rsm, VplSource::Isr).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 7u);
  EXPECT_FALSE(maps(lights, rsm, VplSource::Isr).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 0u);
  lights[0].intensity = vec3(2); // the same surfaces in another light
  const double before = sum(*maps({lights[1]}, rsm, VplSource::Isr).flux, 0).x;
  EXPECT_GT(before, 0);
  maps(lights, rsm, VplSource::Isr);
  lights[0].intensity = vec3(4);
  EXPECT_TRUE(maps(lights, rsm, VplSource::Isr).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 0u);
  lights[1].position.x += 0.1f;
  EXPECT_TRUE(maps(lights, rsm, VplSource::Isr).changed);
  EXPECT_EQ(mapPass.mapsDrawn(), 1u);
  const Aabb above{vec3(0.2f, 0.8f, 0.3f), vec3(0.4f, 0.9f, 0.5f)}; // what moved is above the point light
  EXPECT_TRUE(mapPass.run({placed->gpu(), lights, bounds, false, {&above, 1}, rsm, VplSource::Isr}).changed);
  EXPECT_GT(mapPass.mapsDrawn(), 0u);
  EXPECT_LT(mapPass.mapsDrawn(), 7u);
}

} // namespace lambent::test
