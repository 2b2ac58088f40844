// A sky by day: seen behind surfaces, and as direct light.
#include "frames.h"
#include "tests/support/daylight.h"

namespace lambent::test::sky_test {

class SkyTest : public GlTest {
 protected:
  /// Irradiance of a lone plate in the middle of the picture.
  vec3 plate(const Sky& sky, const vec3& normal) {
    HandScene scene;
    vec3 s, t;
    basisAround(normal, s, t);
    scene.quad(-2.0f * (s + t), 4.0f * s, 4.0f * t, scene.material(vec3(0.5f)));
    scene.camera = cameraAt(3.0f * normal + 0.2f * s, vec3(0), 0.8f);
    LightSet lights;
    lights.sky = scene.sky = sky;
    FrameStats stats;
    Settings settings;
    settings.direct.soft = SoftLightBy::Maps;
    return directOf(passes, scene, lights, settings, stats).at(32, 24);
  }
};

/// Turned, and with a dark place straight below.
Sky pictureOfASky() {
  auto image = std::make_shared<SkyImage>(SkyImage{48, 24, {}});
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 48; ++x)
      image->texels.push_back(y > 21 ? vec3(0.01f) : vec3(0.5f + 0.3f * float(x % 3), 0.1f * float(y), 1));
  return Sky::image(image, 0.7f, 0.9f);
}

TEST_F(SkyTest, BackgroundIsTheSkysRadiance) {
  const Sky skies[] = {Sky::daylight(directionAt(-4, 185), 3), Sky::daylight(directionAt(8, 185), 3),
                       Sky::daylight(directionAt(60, 185), 3), pictureOfASky()};
  for (const bool orthographic : {false, true})
    for (const Sky& sky : skies)
      for (const bool glossy : {false, true}) {
        HandScene scene;
        const uint32_t m = scene.material(vec3(0.5f));
        if (glossy) scene.assets.materials[m].roughness = 0.4f;
        scene.quad(vec3(-0.3f, 0, -1), vec3(0.6f, 0, 0), vec3(0, 0.3f, 0), m);
        scene.sky = sky;
        scene.camera = cameraAt(vec3(0, 0.1f, 0.4f), vec3(0.1f, 0.25f, -1), 1.9f);
        if (orthographic) scene.camera.orthoHalfHeight = 2;
        Settings settings;
        settings.gather.glossy = glossy;
        settings.effects[EffectId::Indirect] = EffectMode::Off;
        Viewer gi(settings);
        gi.run(scene.view());
        const Image beauty = gi.read(Buffer::Beauty), direct = gi.read(Buffer::Direct), depth = gi.read(Buffer::Depth);
        int seen = 0;
        for (const auto [x, y] : Pixels(64, 48)) {
          if (depth.at(x, y).x > 0) continue;
          ++seen;
          const CameraRay ray = pixelRay(scene.camera, x, y);
          const vec3 wanted = scene.sky.radiance(ray.direction);
          const float tolerance = 1e-3f * maxComponent(wanted);
          ASSERT_LT(maxComponent(glm::abs(beauty.at(x, y) - wanted)), tolerance)
              << x << ' ' << y << ' ' << &sky - skies;
          ASSERT_LT(maxComponent(glm::abs(direct.at(x, y) - wanted)), tolerance)
              << x << ' ' << y << ' ' << &sky - skies;
        }
        EXPECT_GT(seen, 1000);
      }
}

TEST_F(SkyTest, OfAPictureBothHalvesOfOpenPlatesAreRight) {
  const Sky sky = pictureOfASky();
  for (const vec3& normal : {vec3(0, 1, 0), vec3(0, -1, 0)}) {
    const dvec3 wanted = openIrradiance(sky, normal);
    EXPECT_LT(maxComponent(glm::abs(dvec3(plate(sky, normal)) - wanted)), 0.01 * wanted.x) << normal.y;
  }
}

TEST_F(SkyTest, DisplayShowsItToo) {
  HandScene scene;
  scene.quad(vec3(-0.3f, -0.3f, -50), vec3(0.6f, 0, 0), vec3(0, 0.3f, 0), scene.material(vec3(0.5f)));
  scene.sky = Sky::daylight(directionAt(20, 150), 3);
  scene.camera = cameraAt(vec3(0), vec3(0, 0.3f, -1), 1.9f);
  Settings settings;
  settings.image.exposure = 1;
  Viewer gi(settings);
  gi.run(scene.view());
  const Image8 beauty = gi.readDisplay(Buffer::Beauty), direct = gi.readDisplay(Buffer::Direct);
  for (size_t i = 0; i < beauty.rgb.size(); ++i) ASSERT_NEAR(beauty.rgb[i], direct.rgb[i], 1) << i;
  EXPECT_GT(beauty.rgb[2], beauty.rgb[0]) << "blue above";
  EXPECT_NE(beauty.rgb[2], beauty.rgb[beauty.rgb.size() - 1]) << "another colour below";
}

TEST_F(SkyTest, DirectLightOfOpenPlates) {
  for (const float elevation : {5.0f, 30.0f, 70.0f}) {
    const Sky sky = Sky::daylight(directionAt(elevation, 65), 3);
    for (const vec3& n : {vec3(0, 1, 0), vec3(0, -1, 0)}) {
      const dvec3 wanted = openIrradiance(sky, n);
      const vec3 light = plate(sky, n);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(light[c], wanted[c], 3e-3 * wanted[c]) << elevation << ' ' << n.y;
    }
    double squares = 0;
    int count = 0;
    for (const vec3& n : {directionAt(0, 65), directionAt(0, 245), directionAt(30, 150), directionAt(60, 0),
                          directionAt(-20, 90), directionAt(10, 300)}) {
      const double wanted = double(luminance(vec3(openIrradiance(sky, n)))), light = double(luminance(plate(sky, n)));
      EXPECT_NEAR(light, wanted, 0.12 * wanted) << elevation << ' ' << n.x << ' ' << n.y;
      squares += (light / wanted - 1) * (light / wanted - 1);
      ++count;
    }
    std::printf("sun %g degrees high: RMS error of tilted plates %.3f\n", double(elevation),
                std::sqrt(squares / count));
    EXPECT_LT(std::sqrt(squares / count), 0.06) << elevation;
  }
}

TEST_F(SkyTest, AChangeIsNoticed) {
  Floor floor;
  floor.scene.sky = Sky::daylight(directionAt(60, 0), 3);
  Settings settings;
  settings.direct.soft = SoftLightBy::Maps; // exact in the first frame
  Viewer gi(settings);
  const Image before = nextFrame(gi, floor.scene.view(), Buffer::Beauty);
  floor.scene.sky = Sky::daylight(directionAt(10, 0), 3);
  const Image after = nextFrame(gi, floor.scene.view(kLightsChanged), Buffer::Beauty);
  const Image anew = firstFrame(settings, floor.scene.view(), Buffer::Beauty);
  EXPECT_LT(luminance(after.at(32, 24)), 0.8f * luminance(before.at(32, 24)));
  for (size_t i = 0; i < after.pixels.size(); ++i) ASSERT_EQ(after.pixels[i], anew.pixels[i]) << i;
}

} // namespace lambent::test::sky_test
