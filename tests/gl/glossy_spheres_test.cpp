// Spheres of each roughness and metalness under each kind of light: the frame's direct light against path tracing that
// knows the same reflection.
#include "frames.h"
#include "tests/support/daylight.h"
#include "tests/support/reference.h"

namespace lambent::test::glossy_spheres_test {

constexpr int kFrames = 64;
constexpr uint32_t kPaths = 512; // of each pixel: 2 % of a smooth metal's light is their noise
constexpr float kRoughnesses[] = {0, 0.15f, 0.4f, 0.7f, 1};

Mesh ball(uint32_t rows, uint32_t material) {
  Mesh mesh;
  const uint32_t columns = 2 * rows;
  for (uint32_t row = 0; row <= rows; ++row)
    for (uint32_t column = 0; column <= columns; ++column) {
      const float down = kPi * float(row) / float(rows), around = 2 * kPi * float(column) / float(columns);
      const vec3 n(std::sin(down) * std::cos(around), std::cos(down), -std::sin(down) * std::sin(around));
      mesh.positions.push_back(n);
      mesh.normals.push_back(n);
    }
  for (uint32_t row = 0; row < rows; ++row)
    for (uint32_t column = 0; column < columns; ++column) {
      const uint32_t a = row * (columns + 1) + column, b = a + columns + 1;
      if (row > 0) mesh.triangles.push_back({a, b, a + 1});
      if (row + 1 < rows) mesh.triangles.push_back({a + 1, b, b + 1});
    }
  for (const vec3& p : mesh.positions) mesh.boundsObject.add(p);
  mesh.primitives.push_back({0, uint32_t(mesh.triangles.size()), material, mesh.boundsObject});
  return mesh;
}

/// Two rows: dielectrics below, metals above.
struct Spheres {
  HandScene scene;

  Spheres() {
    for (int metal = 0; metal < 2; ++metal)
      for (int i = 0; i < 5; ++i) {
        const uint32_t m = scene.glossyMaterial({0.9f, 0.6f, 0.3f}, kRoughnesses[i], float(metal));
        scene.add(ball(48, m), glm::translate(mat4(1), vec3(2.4f * float(i - 2), 2.4f * (float(metal) - 0.5f), 0)));
      }
    scene.camera = cameraAt({0, 0, 30}, {0, 0, 0}, 0.17f, 160, 64);
  }
};

/// What the frame and its reference take, and how near they then are for smooth metals.
struct Effort {
  int frames = kFrames, samples = 2;
  uint32_t paths = kPaths;
  double mostOfSmooth = 0.03; // of the reference
};

class GlossySpheresTest : public GlTest {
 protected:
  /// Within 1 %, and smooth metals, of which a few pixels see the light, within `mostOfSmooth`. Returns the means of
  /// each that the image shows.
  std::vector<double> expectTheReference(Spheres& spheres, const char* name, const Effort& effort = {}) {
    Settings settings;
    settings.effects[EffectId::Indirect] = EffectMode::Off;
    settings.direct.samples = effort.samples;
    settings.direct.frames = effort.frames;
    Viewer gi(settings);
    gi.run(spheres.scene.view());
    for (int i = 1; i < effort.frames; ++i) gi.run(spheres.scene.view(kStill));
    const Image light = gi.read(Buffer::Direct);
    const TracedScene traced(spheres.scene);
    const Image truth = trace({.rays = traced.rays,
                               .lights = traced.lights,
                               .camera = spheres.scene.camera,
                               .bounces = 0,
                               .glossy = &traced.view},
                              effort.paths, ReferenceBuffer::Direct)
                            .mean;
    std::vector<double> got(10), wanted(10), pixels(10);
    for (const auto [x, y] : Pixels(light)) {
      const CameraRay ray = pixelRay(spheres.scene.camera, x, y);
      const SurfaceHit hit = traced.rays.closest(Ray{ray.origin, ray.direction});
      if (!hit.valid() || hit.instance >= 10) continue;
      got[hit.instance] += double(luminance(light.at(x, y)));
      wanted[hit.instance] += double(luminance(truth.at(x, y)));
      ++pixels[hit.instance];
    }
    EXPECT_GT(std::ranges::max(pixels), 300) << "one is seen";
    for (size_t i = 0; i < 10; ++i) {
      if (pixels[i] == 0) continue;
      std::printf("%s, roughness %.2f, metalness %zu: %.4f of the reference\n", name, double(kRoughnesses[i % 5]),
                  i / 5, got[i] / wanted[i]);
      const double most = i >= 5 && kRoughnesses[i % 5] < 0.3f ? effort.mostOfSmooth : 0.01;
      EXPECT_NEAR(got[i], wanted[i], most * wanted[i]) << name << ' ' << i;
      got[i] /= pixels[i];
    }
    return got;
  }
};

void addSun(Spheres& spheres) {
  spheres.scene.lights.push_back({.type = LightType::Directional,
                                  .direction = glm::normalize(vec3(-0.3f, -0.5f, -0.8f)),
                                  .intensity = vec3(3),
                                  .angularRadius = 0.2f});
}

/// Stripes, and a texel as bright as a sun.
void addPicture(Spheres& spheres) {
  auto image = std::make_shared<SkyImage>();
  image->width = 128;
  image->height = 64;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) image->texels.push_back(vec3(0.2f) + vec3(float(x / 16 % 2), 0.5f, float(y / 8 % 2)));
  image->texels[20 * 128 + 96] = vec3(2000); // towards the viewer and up
  spheres.scene.sky = Sky::image(image);
}

TEST_F(GlossySpheresTest, UnderASun) {
  Spheres spheres;
  addSun(spheres);
  expectTheReference(spheres, "sun");
}

TEST_F(GlossySpheresTest, UnderALamp) {
  Spheres spheres;
  spheres.scene.lamp({1, 6, 14}, vec3(300));
  expectTheReference(spheres, "lamp");
}

TEST_F(GlossySpheresTest, UnderAnAreaLight) {
  Spheres spheres;
  spheres.scene.quad({-4, 5, 10}, {0, 0, -6}, {8, 0, 0}, spheres.scene.material(vec3(0), vec3(6)));
  expectTheReference(spheres, "area light");
}

TEST_F(GlossySpheresTest, UnderASky) {
  Spheres spheres;
  spheres.scene.sky = Sky::daylight(directionAt(40, 20), 3);
  expectTheReference(spheres, "sky");
}

TEST_F(GlossySpheresTest, UnderAPictureOfASky) {
  Spheres spheres;
  addPicture(spheres);
  expectTheReference(spheres, "picture");
}

/// What smooth metals mirror of a sun and of a bright texel fills the image: its edges are no pixel's whole light.
TEST_F(GlossySpheresTest, SmoothMetalsUpClose) {
  for (const bool sun : {true, false})
    for (const float x : {-4.8f, -2.4f}) {
      Spheres spheres;
      (sun ? addSun : addPicture)(spheres);
      const vec3 light = sun ? vec3(0.3f, 0.5f, 0.8f) : vec3(-0.02f, 0.534f, 0.845f);
      const vec3 at = vec3(x, 1.2f, 0) + glm::normalize(glm::normalize(light) + vec3(0, 0, 1));
      spheres.scene.camera = cameraAt({at.x, at.y, 30}, at, 0.0124f, 40, 40);
      expectTheReference(spheres, sun ? "sun up close" : "picture up close",
                         {.frames = 64, .samples = 8, .paths = 1024, .mostOfSmooth = 0.01});
    }
}

TEST_F(GlossySpheresTest, InAWhiteFurnace) {
  Spheres spheres;
  spheres.scene.sky = Sky(vec3(1));
  for (Material& m : spheres.scene.assets.materials) m.baseColor = vec3(1);
  for (const double mean : expectTheReference(spheres, "furnace")) {
    EXPECT_LE(mean, 1.005) << "none reflects more than it gets";
    EXPECT_GT(mean, 0.5);
  }
}

/// Indirect light: virtual lights at rough spheres, rays at smooth ones, which show a room of coloured walls.
TEST_F(GlossySpheresTest, InARoom) {
  Spheres spheres;
  const uint32_t white = spheres.scene.material(vec3(0.7f)), red = spheres.scene.material({0.7f, 0.1f, 0.1f}),
                 green = spheres.scene.material({0.1f, 0.6f, 0.2f});
  const vec3 low(-7, -4, -4), size(14, 8, 40);
  const vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  spheres.scene.quad(low, z, x, white);
  spheres.scene.quad(low + y, x, z, white);
  spheres.scene.quad(low, x, y, white);
  spheres.scene.quad(low, y, z, red);
  spheres.scene.quad(low + x, z, y, green);
  spheres.scene.lamp({0, 0.5f, 14}, vec3(60));
  const TracedScene traced(spheres.scene);
  const Image truth = trace({.rays = traced.rays,
                             .lights = traced.lights,
                             .camera = spheres.scene.camera,
                             .bounces = 3,
                             .glossy = &traced.view},
                            kPaths, ReferenceBuffer::Indirect)
                          .mean;
  double error[2][10] = {};
  for (const int mirrors : {0, 1}) {
    Settings settings;
    settings.gather.mirrors = mirrors;
    Viewer gi(settings);
    gi.run(spheres.scene.view());
    for (int i = 1; i < kFrames / 2; ++i) gi.run(spheres.scene.view(kStill));
    EXPECT_EQ(gi.stats().plan.on(EffectId::Mirrors), mirrors > 0);
    const Image light = gi.read(Buffer::Indirect);
    double got[10] = {}, wanted[10] = {}, squares[10] = {};
    for (const auto [px, py] : Pixels(light)) {
      const CameraRay ray = pixelRay(spheres.scene.camera, px, py);
      const SurfaceHit hit = traced.rays.closest(Ray{ray.origin, ray.direction});
      if (!hit.valid() || hit.instance >= 10) continue;
      const double a = double(luminance(light.at(px, py))), b = double(luminance(truth.at(px, py)));
      got[hit.instance] += a;
      wanted[hit.instance] += b;
      squares[hit.instance] += b * b;
      error[mirrors][hit.instance] += (a - b) * (a - b);
    }
    for (size_t i = 0; i < 10; ++i) {
      error[mirrors][i] = std::sqrt(error[mirrors][i] / squares[i]);
      std::printf("room, mirrors %d, roughness %.2f, metalness %zu: %.4f of the reference, RMSE %.3f\n", mirrors,
                  double(kRoughnesses[i % 5]), i / 5, got[i] / wanted[i], error[mirrors][i]);
      if (mirrors) {
        EXPECT_NEAR(got[i], wanted[i], (i == 5 || i == 6 ? 0.015 : 0.07) * wanted[i]) << i;
      }
    }
  }
  for (const size_t smooth : {5, 6}) EXPECT_LT(error[1][smooth], 0.5 * error[0][smooth]);
  for (const size_t rough : {7, 8, 9}) EXPECT_NEAR(error[1][rough], error[0][rough], 1e-3);
}

/// A chrome plate mirrors stripes while the camera passes: what it shows does not move with the plate.
TEST_F(GlossySpheresTest, MirrorsInMotionStaySharp) {
  HandScene scene;
  const uint32_t light = scene.material(vec3(0.8f)), dark = scene.material(vec3(0.1f));
  for (int i = -8; i < 8; ++i) // behind the camera, and facing away from it
    scene.quad({float(i), -4, 6}, {0, 8, 0}, {1, 0, 0}, i % 2 ? light : dark);
  scene.quad({-3, -2, 0}, {6, 0, 0}, {0, 4, 0}, scene.glossyMaterial(vec3(0.9f), 0, 1));
  for (int i = 0; i < 6; ++i)
    scene.lamp({float(i) - 2.5f, 3, 2}, vec3(5)); // rays draw one of them: noise, as of bounces
  const auto at = [&](float x) { scene.camera = cameraAt({x, 0.5f, 4}, {x, 0, 0}, 0.8f, 96, 64); };
  Settings settings;
  settings.smc.vpls = settings.smc.points = 128;
  settings.smc.warmup = 4;
  settings.smc.bounces = 1; // what is mirrored has no noise
  at(-1.5f);
  Viewer gi(settings);
  gi.run(scene.view());
  for (int i = 1; i <= 12; ++i) {
    at(-1.5f + 0.25f * float(i));
    gi.run(scene.view(kCameraChanged));
  }
  const Image moving = gi.read(Buffer::Indirect);
  for (int i = 0; i < 192; ++i) gi.run(scene.view(kStill));
  const double error = relativeRmse(moving, gi.read(Buffer::Indirect));
  std::printf("stripes in a mirror that the camera passes: RMSE %.3f\n", error);
  EXPECT_LT(error, 0.3) << "it was 0.6";
}

} // namespace lambent::test::glossy_spheres_test
