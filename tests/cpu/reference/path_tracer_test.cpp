// The reference against closed forms.
#include "engine/trace/analytic_query.h"
#include "tests/support/reference.h"

namespace lambent::test::path_tracer_test {

/// Camera whose pixels all look at one point: as many independent estimates of it.
CameraView probe(const vec3& eye, const vec3& forward) { return probeAt(eye, eye + forward); }

CameraView looking(const vec3& eye, const vec3& forward, int width, int height) {
  return cameraAt(eye, eye + forward, 1.5f, width, height);
}

/// Within `bound` (relative), and no farther than chance allows.
void expectMean(const Image& image, double expected, double bound, const std::string& what) {
  const Mean m = meanOf(image, {1, 0, 0});
  EXPECT_LT(std::abs(m.mean - expected), bound * expected) << what << ": " << m.mean << " against " << expected;
  EXPECT_TRUE(agrees(m, expected, bound * expected / 2, 1e-5 * expected))
      << what; // single precision of rays and offsets
}

// Closed, emission 1, albedo 1/2: beauty is 1 + 1/2 + … after B bounces, everywhere.
constexpr double kFurnace[4] = {1.5, 1.75, 1.875, 1.9375};

TEST(Reference, WhiteFurnaceOfASphere) {
  AnalyticQuery sphere;
  sphere.addSphere({0, 0, 0}, 2, {vec3(0.5f), vec3(1), true});
  LightSet lights;
  lights.sky = vec3(1e-30f); // never met; says that cosine rays are wanted at the last vertex
  const CameraView camera = looking({0.3f, 0.2f, 0.1f}, {1, 0, 0}, 16, 16);
  for (int bounces = 0; bounces < 4; ++bounces) {
    const ReferenceImage p = trace({sphere, lights, camera, bounces}, 4, ReferenceBuffer::Beauty);
    for (const vec3& pixel : p.mean.pixels) EXPECT_NEAR(pixel.y, kFurnace[bounces], 1e-5);
  }
}

TEST(Reference, WhiteFurnaceOfAMeshRoom) {
  // Emitters that are sampled: connections and cosine rays must share the light exactly, at every vertex.
  HandScene scene;
  scene.box({0, 0, 0}, {2, 1, 3}, scene.material(vec3(0.5f), vec3(1)), true);
  const TracedScene s(scene);
  const CameraView camera = looking({0.7f, 0.5f, 0.2f}, {0.2f, -0.1f, 1}, 48, 48);
  for (int bounces = 0; bounces < 4; ++bounces)
    expectMean(trace({s.rays, s.lights, camera, bounces}, 256, ReferenceBuffer::Beauty).mean, kFurnace[bounces], 1e-3,
               "B = " + std::to_string(bounces));
}

TEST(Reference, PointLightInASphere) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  // Between points of a sphere G is the same everywhere, so wherever the light is, each bounce brings ρ times the mean
  // irradiance of the one before: E = I/R² · (ρ + … + ρ^B).
  const float radius = 2, albedo = 0.5f;
  AnalyticQuery sphere;
  sphere.addSphere({0, 0, 0}, radius, {vec3(albedo)});
  LightSet lights;
  lights.punctual.resize(1);
  lights.punctual[0].intensity = vec3(3);
  const CameraView camera = looking({-1, 0.2f, 0.1f}, {1, 0, 0}, 32, 32);
  for (const vec3& at : {vec3(0), vec3(0.5f, 0.8f, -0.4f)}) {
    lights.punctual[0].position = at;
    double series = 0;
    for (int bounces = 1; bounces <= 3; ++bounces) {
      series += std::pow(albedo, bounces);
      const ReferenceInputs in{sphere, lights, camera, bounces};
      const double irradiance = 3 / (radius * radius) * series;
      expectMean(trace(in, 1024, ReferenceBuffer::Irradiance).mean, irradiance, 2e-3,
                 "irradiance, B = " + std::to_string(bounces));
      expectMean(trace(in, 1024, ReferenceBuffer::Indirect).mean, irradiance * albedo / kPi, 2e-3, "radiance");
    }
  }
}

TEST(Reference, DirectLightOfAPoint) {
  AnalyticQuery plane;
  plane.addPlane({0, 0, 0}, {0, 1, 0}, {vec3(0.6f)});
  LightSet lights;
  lights.sky = vec3(0.25f);
  lights.punctual.resize(1);
  lights.punctual[0].position = {1, 2, 0};
  lights.punctual[0].intensity = vec3(10);
  const CameraView camera = probe({0, 1, 0}, {0, -1, 0});
  const double point = 0.6 / double(kPi) * 10 * 2 / std::pow(5.0, 1.5);
  const ReferenceInputs in{plane, lights, camera, 2};
  for (const ReferenceBuffer buffer : {ReferenceBuffer::Direct, ReferenceBuffer::Beauty})
    expectMean(trace(in, 4, buffer).mean, point + 0.6 * 0.25, 1e-3, "a lone plane under a sky");
  EXPECT_EQ(trace(in, 4, ReferenceBuffer::Indirect).mean.pixels[0], vec3(0));
}

/// Two endless plates, a lamp half-way between them.
class ParallelPlates : public ::testing::Test {
 protected:
  static constexpr double kGap = 2, kAlbedo = 0.5, kIntensity = 10;

  ParallelPlates() {
    plates_.addPlane({0, 0, 0}, {0, 1, 0}, {vec3(kAlbedo)});
    plates_.addPlane({0, kGap, 0}, {0, -1, 0}, {vec3(kAlbedo)});
    lights_.punctual.resize(1);
    lights_.punctual[0].position = {0, kGap / 2, 0};
    lights_.punctual[0].intensity = vec3(kIntensity);
  }

  static double direct(double r) {
    const double h = kGap / 2;
    return kIntensity * h / std::pow(h * h + r * r, 1.5);
  }

  /// Irradiance at distance `at` from the axis that the other plate brings when it receives `from(r)`, with G at most
  /// `clamp`: ∫ ρ/π · from · min(G, clamp) dA, midpoint rule in polar coordinates around the receiver, radius stretched
  /// by r = gap·tan.
  template <class From> static double transfer(double at, const From& from, double clamp) {
    constexpr int kRadii = 2000, kAngles = 128;
    double sum = 0;
    for (int i = 0; i < kRadii; ++i) {
      const double theta = (i + 0.5) / kRadii * std::acos(0.0), r = kGap * std::tan(theta);
      const double width = kGap / (std::cos(theta) * std::cos(theta)) * std::acos(0.0) / kRadii;
      const double d2 = kGap * kGap + r * r, g = std::min(kGap * kGap / (d2 * d2), clamp);
      double ring = 0; // mean of `from` around the ring
      for (int j = 0; j < kAngles; ++j) {
        const double phi = (j + 0.5) / kAngles * 2 * std::acos(0.0); // half the ring, the other half mirrors it
        ring += from(std::sqrt(r * r + at * at + 2 * r * at * std::cos(phi))) / kAngles;
      }
      sum += kAlbedo / double(kPi) * ring * g * 2 * double(kPi) * r * width;
    }
    return sum;
  }

  AnalyticQuery plates_;
  LightSet lights_;
};

TEST_F(ParallelPlates, OneBounce) {
  for (const float at : {0.0f, 1.3f}) {
    const CameraView camera = probe({at, 0.5f, 0}, {0, -1, 0});
    expectMean(trace({plates_, lights_, camera, 1}, 2048, ReferenceBuffer::Irradiance).mean, transfer(at, direct, 1e30),
               2e-3, "at " + std::to_string(at));
  }
}

TEST_F(ParallelPlates, TwoBounces) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  // What the first bounce brings, tabulated over the radius; beyond the table it is nothing (1e-4 of the total).
  constexpr int kEntries = 200;
  constexpr double kStep = 0.1;
  std::vector<double> first;
  for (int i = 0; i <= kEntries; ++i) first.push_back(transfer(i * kStep, direct, 1e30));
  const auto interpolated = [&](double r) {
    const double x = r / kStep;
    const int i = int(x);
    return i >= kEntries ? 0.0 : first[i] + (x - i) * (first[i + 1] - first[i]);
  };
  const CameraView camera = probe({0.4f, 0.5f, 0}, {0, -1, 0});
  expectMean(trace({plates_, lights_, camera, 2}, 2048, ReferenceBuffer::Irradiance).mean,
             interpolated(0.4) + transfer(0.4, interpolated, 1e30), 2e-3, "first and second bounce");
}

TEST_F(ParallelPlates, ClampedGeometryTerm) {
  const CameraView camera = probe({0.7f, 0.5f, 0}, {0, -1, 0});
  // G is 1/gap² = 0.25 right above: the bound takes a good part of the light.
  const double clamped = transfer(0.7, direct, 0.1), whole = transfer(0.7, direct, 1e30);
  EXPECT_LT(clamped, 0.8 * whole);
  expectMean(trace({plates_, lights_, camera, 1, 0.1f}, 2048, ReferenceBuffer::Irradiance).mean, clamped, 2e-3,
             "clamped");
  expectMean(trace({plates_, lights_, camera, 1, 10.0f}, 2048, ReferenceBuffer::Irradiance).mean, whole, 2e-3,
             "a bound that nothing reaches");
}

TEST(Reference, PixelCentresAndBackground) {
  // A quad that covers the left half of the picture exactly, seen from the front.
  HandScene scene;
  scene.quad({-10, -10, -1}, {10, 0, 0}, {0, 20, 0}, scene.material(vec3(0.5f), vec3(2)));
  scene.sky = vec3(0.25f);
  const TracedScene s(scene);
  CameraView camera = cameraAt({0, 0, 0}, {0, 0, -1}, 1, 8, 4);
  const ReferenceInputs in{s.rays, s.lights, camera, 1};
  const ReferenceImage p = trace(in, 2, ReferenceBuffer::Beauty);
  for (const auto [x, y] : Pixels(8, 4)) {
    EXPECT_EQ(p.surface[y * 8 + x], x < 4);
    EXPECT_NEAR(p.mean.at(x, y).x, x < 4 ? 2 + 0.5 * 0.25 : 0.25, 1e-5);
  }
  EXPECT_EQ(trace(in, 2, ReferenceBuffer::Indirect).mean.at(7, 0), vec3(0));
  camera.near = 1.5f; // beyond the quad, which the rasteriser would clip
  EXPECT_EQ(trace({s.rays, s.lights, camera, 1}, 2, ReferenceBuffer::Beauty).surface[0], 0);
}

} // namespace lambent::test::path_tracer_test
