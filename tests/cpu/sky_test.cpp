// The sky's model, its sampling, and the light that VPLs and photons take from it.
#include "engine/core/rng.h"
#include "engine/scene/scene.h"
#include "gi/lighting/dirty_region.h"
#include "gi/lighting/light_paths.h"
#include "gi/lighting/photons.h"
#include "tests/support/comparator_world.h"
#include "tests/support/daylight.h"

namespace lambent::test::sky_test {

constexpr float kTurbidities[] = {1.7f, 2, 2.5f, 3, 4, 6, 8, 10};

// The model -----------------------------------------------------------------------------------------------------------

bool isLight(const vec3& l) { return isFinite(l) && luminance(l) > 0 && l.x >= 0 && l.y >= 0 && l.z >= 0; }

TEST(Daylight, IsFiniteAndPositiveEverywhere) {
  for (float elevation = -90; elevation <= 90; elevation += 5)
    for (const float turbidity : kTurbidities) {
      const Sky sky = Sky::daylight(directionAt(elevation, 40), turbidity);
      EXPECT_FALSE(sky.black() || sky.constant());
      const vec3 sun = daylightSun(directionAt(elevation, 40), turbidity);
      EXPECT_TRUE(isFinite(sun) && sun.x >= 0 && sun.y >= 0 && sun.z >= 0);
      for (const vec3& d :
           {vec3(0, 1, 0), vec3(0, -1, 0), vec3(1, 0, 0), directionAt(elevation, 40), directionAt(-elevation, 220)}) {
        ASSERT_TRUE(isLight(sky.radiance(d))) << elevation << ' ' << turbidity;
      }
      overSphere(32, [&](const vec3& d) {
        const vec3 l = sky.radiance(d);
        EXPECT_TRUE(isLight(l)) << elevation << ' ' << turbidity;
        EXPECT_LT(luminance(l), 6) << elevation << ' ' << turbidity; // the unit: a white surface in the sun is about 1
        return 1.0;
      });
    }
}

TEST(Daylight, IsBrightestAtTheSun) {
  for (const float elevation : {5.0f, 20.0f, 45.0f, 70.0f})
    for (const float turbidity : {2.5f, 3.0f, 6.0f}) {
      const vec3 sun = directionAt(elevation, -70);
      const Sky sky = Sky::daylight(sun, turbidity);
      vec3 brightest(0);
      overSphere(128, [&](const vec3& d) {
        if (luminance(sky.radiance(d)) > luminance(sky.radiance(brightest))) brightest = d;
        return 1.0;
      });
      // Turbid air is brighter towards the horizon, and draws the place down to it.
      EXPECT_GT(glm::dot(brightest, sun), std::cos(glm::radians(12.0f))) << elevation << ' ' << turbidity;
    }
}

TEST(Daylight, ZenithIsAsPublished) {
  // Luminance at the zenith in kcd/m² (Preetham et al. 1999, appendix 2), in double; the unit is 100/π kcd/m².
  const double pi = std::acos(-1.0);
  // Its chromaticity: polynomials in the turbidity and the sun's angle from the zenith.
  const glm::dmat3x4 ofX({0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394},
                         {0.11693, -0.21196, 0.06052, 0.25886});
  const glm::dmat3x4 ofY({0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516},
                         {0.15346, -0.26756, 0.06670, 0.26688});
  for (const double elevation : {2.0, 30.0, 60.0, 88.0})
    for (const double t : {2.0, 3.0, 6.0}) {
      const double fromZenith = (90 - elevation) * pi / 180, chi = (4.0 / 9 - t / 120) * (pi - 2 * fromZenith);
      const double wanted = ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192) * pi / 100;
      const vec3 zenith = Sky::daylight(directionAt(float(elevation), 10), float(t)).radiance({0, 1, 0});
      EXPECT_NEAR(luminance(zenith), wanted, 2e-3 * wanted) << elevation << ' ' << t;
      if (t > 4) continue;
      const double s = fromZenith;
      const auto chromaticity = [&](const glm::dmat3x4& of) {
        return glm::dot(of * dvec3(t * t, t, 1), glm::dvec4(s * s * s, s * s, s, 1));
      };
      const dvec3 c(zenith); // linear Rec.709, to CIE XYZ
      const dvec3 xyz(0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z, 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z,
                      0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z);
      EXPECT_NEAR(xyz.x / (xyz.x + xyz.y + xyz.z), chromaticity(ofX), 1e-3) << elevation << ' ' << t;
      EXPECT_NEAR(xyz.y / (xyz.x + xyz.y + xyz.z), chromaticity(ofY), 1e-3) << elevation << ' ' << t;
    }
}

TEST(Daylight, GroundIsLitBySkyAndSun) {
  for (const float elevation : {-3.0f, 10.0f, 50.0f}) {
    const vec3 towards = directionAt(elevation, 100);
    const Sky sky = Sky::daylight(towards, 3);
    const dvec3 open = openIrradiance(sky, {0, 1, 0});
    const vec3 sun = daylightSun(towards, 3) * std::max(0.0f, towards.y), ground = sky.radiance({0.3f, -0.2f, 0.1f});
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(sky.irradiance()[c], open[c], 2e-3 * open[c]) << elevation;
      EXPECT_NEAR(ground[c], 0.2 / std::acos(-1.0) * (open[c] + double(sun[c])), 2e-3 * double(ground[c])) << elevation;
    }
  }
}

TEST(Daylight, FadesAtDuskAndTurnsWithTheSun) {
  const auto brightness = [](float elevation) { return Sky::daylight(directionAt(elevation, 0), 3).meanLuminance(); };
  EXPECT_GT(brightness(40), brightness(10));
  EXPECT_GT(brightness(10), brightness(0));
  EXPECT_NEAR(brightness(-3) / brightness(-1e-4f), 0.1f, 2e-3f);
  EXPECT_NEAR(brightness(-50) / brightness(-18), 1, 1e-3f);
  EXPECT_EQ(daylightSun(directionAt(-1, 0), 3), vec3(0));
  const vec3 low = daylightSun(directionAt(5, 0), 3), high = daylightSun(directionAt(80, 0), 3);
  EXPECT_GT(low.x, 3 * low.z) << "red";
  EXPECT_GT(luminance(high), 2.5f);
  EXPECT_LT(luminance(high), 3.5f) << "about π";
  const Sky east = Sky::daylight(directionAt(30, 90), 3);
  EXPECT_GT(luminance(east.radiance(directionAt(30, 90))), 2 * luminance(east.radiance(directionAt(30, -90))));
}

TEST(Daylight, IsComparedByWhatItFollowsFrom) {
  EXPECT_EQ(Sky(), Sky(vec3(0)));
  EXPECT_NE(Sky(vec3(1)), Sky(vec3(1, 1, 2)));
  const Sky a = Sky::daylight(directionAt(30, 0), 3);
  EXPECT_EQ(a, Sky::daylight(directionAt(30, 0), 3));
  EXPECT_NE(a, Sky::daylight(directionAt(30, 1), 3));
  EXPECT_NE(a, Sky::daylight(directionAt(30, 0), 4));
  EXPECT_NE(a, Sky(vec3(1)));
}

// Sampling ------------------------------------------------------------------------------------------------------------

/// Frequencies against the density, over cells half as large as the table's.
void expectDensity(const std::function<SkySample(vec2)>& sample, const std::function<float(const vec3&)>& pdf,
                   const Sky& sky, const std::string& what) {
  constexpr int kRows = 64, kColumns = 64, kSamples = 400000;
  const auto place = [](const vec3& d) {
    double turn = std::atan2(double(d.z), double(d.x)) / (2 * std::acos(-1.0));
    if (turn < 0) turn += 1;
    return std::pair(std::min(kRows - 1, int((0.5 - 0.5 * double(d.y)) * kRows)),
                     std::min(kColumns - 1, int(turn * kColumns)));
  };
  std::vector<double> observed(kRows * kColumns, 0), expected(kRows * kColumns, 0);
  Rng rng(5, Stream::Test, 0);
  for (int i = 0; i < kSamples; ++i) {
    const SkySample s = sample(rng.next2());
    ASSERT_NEAR(glm::length(s.direction), 1, 1e-5f);
    ASSERT_EQ(s.radiance, sky.radiance(s.direction));
    ASSERT_GT(s.pdf, 0);
    ASSERT_EQ(s.pdf, pdf(s.direction)) << what;
    const auto [row, column] = place(s.direction);
    ++observed[row * kColumns + column];
  }
  double total = 0;
  const double cell = 4 * std::acos(-1.0) / (kRows * kColumns);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double y = 1 - (2 * row + 1.0) / kRows, r = std::sqrt(1 - y * y),
                   phi = 2 * std::acos(-1.0) * (column + 0.5) / kColumns;
      const double p = double(pdf(vec3(float(r * std::cos(phi)), float(y), float(r * std::sin(phi))))) * cell;
      expected[row * kColumns + column] = p * kSamples;
      total += p;
    }
  EXPECT_NEAR(total, 1, 1e-5) << what;
  EXPECT_LT(chiSquareDeviate(observed, expected), kDeviateLimit) << what;
}

TEST(SkySampling, FollowsItsDensity) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  for (const float elevation : {3.0f, 40.0f}) {
    const Sky sky = Sky::daylight(directionAt(elevation, 60), 3);
    expectDensity([&](vec2 u) { return sky.sample(u); }, [&](const vec3& d) { return sky.pdf(d); }, sky, "all");
    for (const vec3& n : {vec3(0, 1, 0), vec3(0, -1, 0), vec3(1, 0, 0), glm::normalize(vec3(-1, 0.3f, 2))})
      expectDensity([&](vec2 u) { return sky.sampleFacing(n, u); }, [&](const vec3& d) { return sky.pdfFacing(n, d); },
                    sky, "facing");
  }
  const Sky constant(vec3(2));
  expectDensity([&](vec2 u) { return constant.sample(u); }, [&](const vec3& d) { return constant.pdf(d); }, constant,
                "constant");
}

TEST(SkySampling, IsByWhatArrives) {
  const Sky sky = Sky::daylight(directionAt(20, 130), 3);
  EXPECT_NEAR(sky.meanLuminance() * 4 * kPi,
              overSphere(512, [&](const vec3& d) { return double(luminance(sky.radiance(d))); }),
              1e-2 * double(sky.meanLuminance()) * 12);
  // Luminance over density is nearly the same everywhere: its scatter is that of the cells.
  Rng rng(2, Stream::Test, 1);
  const vec3 n(0, 1, 0);
  double sum = 0, squares = 0;
  for (int i = 0; i < 100000; ++i) {
    const SkySample s = sky.sampleFacing(n, rng.next2());
    const double x = double(luminance(s.radiance)) * std::max(0.0, double(s.direction.y)) / double(s.pdf);
    sum += x / 100000, squares += x * x / 100000;
  }
  EXPECT_NEAR(sum, double(luminance(sky.irradiance())), 0.01 * sum);
  EXPECT_LT(squares / sum / sum - 1, 0.1); // 1.2 by the cosine alone, see below
}

// Light paths ---------------------------------------------------------------------------------------------------------

/// A room of 4 m × 3 m × 4 m, a window of 1.2 m × 1 m in its +x wall, without glass.
struct WindowRoom {
  HandScene scene;
  vec3 lo{-2, 0, -2}, hi{2, 3, 2};

  explicit WindowRoom(const vec3& albedo = vec3(0.5f)) {
    const uint32_t m = scene.material(albedo);
    const vec3 d = hi - lo, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    scene.quad(lo, y, z, m);                            // −x
    scene.quad(lo, z, x, m);                            // floor
    scene.quad(lo + y, x, z, m);                        // ceiling
    scene.quad(lo, x, y, m);                            // −z
    scene.quad(lo + z, y, x, m);                        // +z
    scene.quad({2, 0, -2}, {0, 0, 4}, {0, 1, 0}, m);    // below the window
    scene.quad({2, 2, -2}, {0, 0, 4}, {0, 1, 0}, m);    // above
    scene.quad({2, 1, -2}, {0, 0, 1.4f}, {0, 1, 0}, m); // beside
    scene.quad({2, 1, 0.6f}, {0, 0, 1.4f}, {0, 1, 0}, m);
  }
};

/// Irradiance/π through the window, by a fine sum over it.
double throughWindow(const Sky& sky, const vec3& at, const vec3& normal) {
  constexpr int kSteps = 200;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const dvec3 p(2, 1 + (i + 0.5) / kSteps, -0.6 + 1.2 * (j + 0.5) / kSteps), d = p - dvec3(at);
      const double r2 = glm::dot(d, d), cosine = glm::dot(d, dvec3(normal)) / std::sqrt(r2);
      if (cosine <= 0) continue;
      sum += double(luminance(sky.radiance(glm::normalize(vec3(d))))) * cosine * d.x / std::sqrt(r2) / r2 * 1.2 /
             (kSteps * kSteps);
    }
  return sum / std::acos(-1.0);
}

TEST(SkyPaths, ThroughAWindowWithoutFireflies) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  const WindowRoom room;
  const TracedScene traced(room.scene);
  const EmbreeQuery& rays = traced.rays;
  struct Place {
    vec3 at, normal;
  };
  const Place places[] = {{{1, 0, 0}, {0, 1, 0}},
                          {{-1.5f, 0, 0.5f}, {0, 1, 0}},
                          {{-2, 1, 0.5f}, {1, 0, 0}},
                          {{0, 3, 0.3f}, {0, -1, 0}},
                          {{0.3f, 1.2f, 2}, {0, 0, -1}}};
  double ratios = 0, worst = 0;
  int cases = 0;
  for (const float elevation : {5.0f, 30.0f, 70.0f})
    for (const float azimuth : {90.0f, 200.0f, 270.0f}) {
      LightSet lights;
      lights.sky = Sky::daylight(directionAt(elevation, azimuth), 3);
      double brightest = 0;
      overSphere(128, [&](const vec3& d) {
        brightest = std::max(brightest, double(luminance(lights.sky.radiance(d))));
        return 1.0;
      });
      for (const Place& place : places) {
        const PathVertex vertex{place.at, place.normal, place.normal};
        const vec3 origin = offsetPoint(place.at, place.normal, rays.rayEpsilon());
        constexpr int kSamples = 40000;
        std::vector<double> byCosine, together;
        double largest = 0;
        Rng rng(3, Stream::Test, uint32_t(cases));
        std::vector<Ray> first, second;
        std::vector<vec3> values;
        for (int i = 0; i < kSamples; ++i) {
          first.push_back({origin, sampleCosineHemisphere(place.normal, rng.next2())});
          const LightConnection c = connectToSky(lights, vertex, vec3(1), rng.next2(), rays.rayEpsilon());
          second.push_back(maxComponent(c.value) > 0 ? c.segment : first.back());
          values.push_back(c.value);
        }
        std::vector<uint8_t> blockedFirst(kSamples), blockedSecond(kSamples);
        rays.occluded(first, blockedFirst);
        rays.occluded(second, blockedSecond);
        for (int i = 0; i < kSamples; ++i) {
          const vec3 d = first[i].direction;
          const double whole = blockedFirst[i] ? 0 : double(luminance(lights.sky.radiance(d)));
          const double share = blockedFirst[i] ? 0 : double(luminance(skyByRay(lights, vertex, d)));
          const double connected = blockedSecond[i] ? 0 : double(luminance(values[i]));
          ASSERT_LE(share, whole * (1 + 1e-6));
          ASSERT_LE(connected, 0.51 * brightest) << "x/(1 + x²) of the radiance, at most half";
          byCosine.push_back(whole);
          together.push_back(share + connected);
          largest = std::max(largest, share + connected);
        }
        const double truth = throughWindow(lights.sky, place.at, place.normal);
        const Mean a = meanOf(byCosine), b = meanOf(together);
        EXPECT_TRUE(agrees(a, truth, kInfinity, 1e-3 * truth));
        EXPECT_TRUE(agrees(b, truth, kInfinity, 1e-3 * truth));
        EXPECT_LE(largest, 1.51 * brightest);
        // Two rays each: variance of the mean of two cosine rays is half of one's.
        const double ratio = b.error * b.error / (0.5 * a.error * a.error);
        ratios += ratio;
        worst = std::max(worst, ratio);
        ++cases;
      }
    }
  RecordProperty("mean_ratio", std::to_string(ratios / cases));
  std::printf("variance at equal rays over that of cosine rays: mean %.2f, largest %.2f\n", ratios / cases, worst);
  EXPECT_LT(ratios / cases, 1);
  EXPECT_LT(worst, 1.5);
}

TEST(SkyPaths, RadiosityOfOpenPlanesAndOfARoom) {
  AnalyticQuery nothing;
  nothing.addSphere({0, -100, 0}, 0.1f, {});
  LightSet lights;
  lights.sky = Sky::daylight(directionAt(25, 75), 3);
  for (const vec3& n :
       {vec3(0, 1, 0), vec3(0, -1, 0), glm::normalize(vec3(1, 0.4f, 0)), glm::normalize(vec3(-1, -0.2f, 2))}) {
    const double wanted = 0.5 / std::acos(-1.0) * double(luminance(vec3(openIrradiance(lights.sky, n))));
    for (const int paths : {8, 16}) {
      std::vector<double> values;
      for (uint64_t id = 1; id <= 500; ++id)
        values.push_back(double(luminance(radianceOf(vplAt(vec3(0), n, id), nothing, lights, 1, paths))));
      EXPECT_TRUE(agrees(meanOf(values), wanted, 0.25 * wanted / std::sqrt(500.0), 1e-3 * wanted)) << n.x << ' ' << n.y;
    }
  }
  const WindowRoom room;
  const TracedScene traced(room.scene);
  const EmbreeQuery& rays = traced.rays;
  std::vector<double> values;
  for (uint64_t id = 1; id <= 4000; ++id)
    values.push_back(double(luminance(radianceOf(vplAt({-1, 0, 0.5f}, {0, 1, 0}, id), rays, lights, 1, 16))));
  const double wanted = 0.5 * throughWindow(lights.sky, {-1, 0, 0.5f}, {0, 1, 0});
  EXPECT_TRUE(agrees(meanOf(values), wanted, 0.03 * wanted, 1e-3 * wanted));
}

/// Of rays by the cosine. Those of lobes reach there too; a cosine of 0 weighs them.
TEST(SkyPaths, NothingComesFromBelowTheShadingHorizon) {
  LightSet lights;
  lights.sky = Sky::daylight(directionAt(25, 75), 3);
  const PathVertex vertex{vec3(0), {0, 1, 0}, {0.6f, 0.8f, 0}};
  int below = 0;
  overSphere(64, [&](const vec3& d) {
    if (d.y <= 0 && glm::dot(d, vertex.geometricNormal) > 0) {
      ++below;
      EXPECT_EQ(skyByRay(lights, vertex, d), vec3(0)) << d.x << ' ' << d.y << ' ' << d.z;
    }
    return 0.0;
  });
  EXPECT_GT(below, 100);
}

/// Kept paths give what paths from scratch do, whatever becomes of the sky and of what stands before the window.
TEST(SkyPaths, KeptThroughChangesOfSkyAndGeometry) {
  WindowRoom room;
  const uint32_t m = room.scene.material(vec3(0.4f));
  const uint32_t shutter = room.scene.quad({2.5f, 0.5f, -1}, {0, 0, 1.2f}, {0, 2, 0}, m);
  EmbreeQuery rays(room.scene.assets);
  rays.update(room.scene.view());
  std::vector<Vpl> vpls;
  for (uint64_t id = 1; id <= 40; ++id) vpls.push_back(vplAt({-1.8f + 0.09f * float(id), 0, 0.5f}, {0, 1, 0}, id));
  std::vector<KeptPaths> kept(vpls.size());
  const Sky day = Sky::daylight(directionAt(20, 90), 3), dusk = Sky::daylight(directionAt(-5, 90), 5);
  const Sky skies[] = {
      day, Sky::daylight(directionAt(40, 70), 3), Sky(vec3(1, 2, 3)), Sky(), day, day, dusk, Sky(vec3(1)), day};
  LightSet lights;
  uint64_t asked = 0;
  int different = 0;
  for (int step = 0; step < 18; ++step) {
    const Sky before = lights.sky;
    lights.sky = skies[step % std::size(skies)];
    room.scene.move(shutter, {0, 0, step % 2 == 0 ? 0 : step % 4 == 1 ? 0.4f : -0.4f});
    room.scene.instances[shutter].moved = step % 2 == 1;
    const SceneView view = room.scene.view();
    rays.update(view);
    const DirtyRegion moved(view);
    RadianceUpdate update;
    update.paths = 32;
    update.moved = &moved;
    update.lightsChanged = lights.sky != before;
    std::vector<RadianceJob> jobs;
    for (size_t i = 0; i < vpls.size(); ++i) jobs.push_back({&vpls[i], nullptr, &kept[i]});
    const PathCounts counts = estimateRadiance(jobs, rays, lights, update);
    if (step == 1) asked = counts.rays.occlusion;
    std::vector<Vpl> anew = vpls;
    jobs.clear();
    for (Vpl& v : anew) jobs.push_back({&v});
    estimateRadiance(jobs, rays, lights, update);
    for (size_t i = 0; i < vpls.size(); ++i) {
      EXPECT_EQ(vpls[i].radiance, anew[i].radiance) << "VPL " << i << ", step " << step;
      different += luminance(anew[i].radiance) > 0;
    }
  }
  EXPECT_GT(asked, 0u);
  EXPECT_GT(different, 300) << "too dark to tell";
}

TEST(SkyPaths, PhotonsBringWhatTheSkySends) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  // A plate with both sides, under the sky: what arrives from above and from below.
  LightSet lights;
  lights.sky = Sky::daylight(directionAt(15, 40), 3);
  const Aabb bounds{vec3(-1), vec3(1)};
  const PhotonSource source(lights, bounds, 1e-6f);
  ASSERT_FALSE(source.empty());
  for (const vec3& n : {vec3(0, 1, 0), vec3(0, -1, 0), directionAt(15, 40), directionAt(0, 220)}) {
    const double area = 0.25, wanted = area * double(luminance(vec3(openIrradiance(lights.sky, n))));
    vec3 s = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0))), t = glm::cross(n, s);
    std::vector<double> means;
    for (uint32_t seed = 0; seed < 20; ++seed) {
      double sum = 0;
      constexpr uint32_t kPhotons = 20000;
      for (uint32_t i = 0; i < kPhotons; ++i) {
        const Photon p = source.emit(photonNumbers(i, seed));
        const float along = glm::dot(p.ray.direction, n);
        if (along >= 0) continue;
        const vec3 at = p.ray.origin - p.ray.direction * (glm::dot(p.ray.origin, n) / along);
        if (std::abs(glm::dot(at, s)) < 0.25f && std::abs(glm::dot(at, t)) < 0.25f)
          sum += double(luminance(p.flux)) / kPhotons;
      }
      means.push_back(sum);
    }
    EXPECT_TRUE(agrees(meanOf(means), wanted, 0.03 * wanted, 1e-3 * wanted)) << n.x << ' ' << n.y;
  }
}

} // namespace lambent::test::sky_test
