// Photons from every kind of light against closed forms, through the `ir` sampler where the light must end up in VPLs,
// and the resampling that the comparators share.
#include "gi/lighting/photons.h"
#include "tests/support/comparator_world.h"

namespace lambent::test::photons_test {

using World = ComparatorWorld;

TEST(Photons, PunctualLightsInAClosedRoomLoseNothing) {
  // Nothing leaves a closed room: bounce b reflects Φ ρ^b, exactly, whatever way the photons went.
  LightView point = lampAt({0.4f, 1, 0.2f}, 3), spot = point;
  spot.type = LightType::Spot;
  spot.outerConeCos = 0.5f;
  spot.innerConeCos = 0.8f;
  // ∫ of ((c − 0.5)/0.3)² over the ramp, and of 1 over the plateau.
  const double spotFlux = 3 * 2 * double(kPi) * (0.1 + 0.2);
  for (const auto& [light, flux] : {std::pair{point, 3 * 4 * double(kPi)}, std::pair{spot, spotFlux}}) {
    for (int bounces : {1, 2, 3, 5}) {
      World world(VplSource::Ir);
      world.rays = {};
      world.rays.addBox({-3, 0, -3}, {3, 3, 3}, {vec3(0.6f)});
      world.lights.punctual = {light};
      world.settings.bounces = bounces;
      EXPECT_EQ(world.update().alive, 256u);
      double expected = 0;
      for (int b = 1; b <= bounces; ++b) expected += flux * std::pow(0.6, b) / double(kPi);
      EXPECT_NEAR(world.power(), expected, 2e-4 * expected) << bounces << " bounces";
    }
  }
}

TEST(Photons, GlowingSurfacesSendTheirPower) {
  // An open lamp inside a closed room: π L A per side.
  for (bool doubleSided : {false, true}) {
    HandScene scene;
    scene.box({-2, 0, -2}, {2, 3, 2}, scene.material(vec3(0.5f)), true);
    scene.quad({-0.5f, 2, -0.3f}, {1, 0, 0}, {0, 0.2f, 0.6f}, scene.material(vec3(0.5f), vec3(4), doubleSided));
    const TracedScene traced(scene);
    const SmcSettings settings{.vpls = 512, .bounces = 2};
    VplSet set;
    VplUpdateLog log;
    placeVpls(VplSource::Ir, set, {traced.view, traced.rays, traced.lights, settings, 1, {}}, log);
    const double area = std::sqrt(0.36 + 0.04), expected = (doubleSided ? 2 : 1) * 4 * area * (0.5 + 0.25);
    EXPECT_NEAR(powerOf(set.slots), expected, 1e-3 * expected);
  }
}

TEST(Photons, SunAndSkyOnASphere) {
  // Irradiance E of a sun falls on the cross section, πR²; a sky of radiance L lights all of a convex body with πL.
  for (bool sky : {false, true}) {
    std::vector<double> powers;
    for (uint32_t seed = 0; seed < 40; ++seed) {
      World world(VplSource::Ir);
      world.rays = {};
      world.rays.addSphere({1, 2, 3}, 1.5f, {vec3(0.5f)});
      world.view.boundsWorld = {vec3(-2, 0, 0), vec3(4, 5, 5)};
      world.lights.punctual.clear();
      if (sky) {
        world.lights.sky = vec3(2);
      } else {
        world.lights.punctual = {
            {.type = LightType::Directional, .direction = glm::normalize(vec3(1, -2, 0.5f)), .intensity = vec3(2)}};
      }
      world.settings.bounces = 1;
      EXPECT_LT(world.update(seed).alive, 256u); // many miss: the price that paper 1 names
      powers.push_back(world.power());
    }
    const double pi = double(kPi), area = pi * 2.25;
    const double expected = 0.5 * (sky ? 2 * 4 * area : 2 * area / pi);
    EXPECT_TRUE(agrees(meanOf(powers), expected, 0.03 * expected)) << (sky ? "sky" : "sun");
  }
}

TEST(Photons, SpotFollowsItsFalloff) {
  LightSet lights;
  LightView spot = lampAt({0, 0, 0}, 1);
  spot.type = LightType::Spot;
  spot.direction = glm::normalize(vec3(1, -1, 0.5f));
  spot.outerConeCos = 0.4f;
  spot.innerConeCos = 0.9f;
  lights.punctual = {spot};
  const PhotonSource source(lights, {vec3(-1), vec3(1)}, 1e-4f);
  constexpr int kCells = 24, kPhotons = 100000;
  std::vector<double> observed(kCells, 0), expected(kCells, 0);
  Rng rng(3, Stream::Test, 0);
  for (int i = 0; i < kPhotons; ++i) {
    const Photon p = source.emit({rng.next(), rng.next2(), rng.next2()});
    const float cosine = glm::dot(p.ray.direction, spot.direction);
    ++observed[size_t(glm::clamp((cosine - 0.4f) / 0.6f * kCells, 0.0f, kCells - 1.0f))];
  }
  double total = 0;
  for (int cell = 0; cell < kCells * 100; ++cell) { // fine enough to integrate numerically
    const double c = 0.4 + 0.6 * (cell + 0.5) / (kCells * 100), a = std::min(1.0, (c - 0.4) / 0.5);
    expected[size_t(cell / 100)] += a * a;
    total += a * a;
  }
  for (double& e : expected) e *= kPhotons / total;
  EXPECT_LT(chiSquareDeviate(observed, expected), kDeviateLimit);
}

TEST(Photons, LightsAreChosenByPowerAndRangeIsKept) {
  LightSet lights;
  lights.punctual = {lampAt({0, 1, 0}, 1), lampAt({5, 1, 0}, 3)};
  lights.punctual[1].range = 2;
  const PhotonSource source(lights, {vec3(-1), vec3(6)}, 1e-4f);
  int second = 0;
  for (uint32_t i = 0; i < 1000; ++i) {
    const Photon p = source.emit(photonNumbers(i, 1));
    EXPECT_NEAR(p.flux.x, 16 * kPi, 1e-3f); // all photons alike
    second += p.ray.origin.x > 1;
    if (p.ray.origin.x < 1) continue;
    SurfaceHit hit;
    hit.normal = hit.geometricNormal = -p.ray.direction;
    hit.t = 1;
    EXPECT_NEAR(arrivingFlux(p, hit).x, (1 - 1 / 16.0f) * p.flux.x, 1e-3f);
    hit.t = 2.5f;
    EXPECT_EQ(arrivingFlux(p, hit), vec3(0));
  }
  EXPECT_NEAR(second, 750, 5); // a low-discrepancy sequence keeps proportions closely
}

TEST(Photons, EverySubsetOfInterleavedSamplingIsEven) {
  // Slots of one class, slot mod 16, must see all light. The mean of a coordinate over 43 random photons is known to
  // 1/√(12·43) = 0.044; a run of the sequence must do better.
  constexpr uint32_t kPhotons = 683;
  using Numbers = std::array<double, 5>;
  Numbers squares{};
  for (uint32_t c = 0; c < 16; ++c) {
    Numbers sum{};
    int count = 0;
    for (uint32_t i = c; i < kPhotons; i += 16, ++count) {
      const PhotonNumbers n = photonNumbers(sequenceIndex(i, kPhotons), 5);
      const float of[5] = {n.direction.x, n.direction.y, n.light, n.position.x, n.position.y};
      for (size_t k = 0; k < 5; ++k) sum[k] += double(of[k]);
    }
    for (size_t k = 0; k < 5; ++k) squares[k] += std::pow(sum[k] / count - 0.5, 2) / 16;
  }
  for (size_t k = 0; k < 5; ++k) EXPECT_LT(std::sqrt(squares[k]), k < 2 ? 0.03 : 0.02) << k;
  std::vector<uint32_t> all;
  for (uint32_t i = 0; i < kPhotons; ++i) all.push_back(sequenceIndex(i, kPhotons));
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
}

TEST(SystematicResampling, DrawsExpectedNumbers) {
  Rng rng(1, Stream::Test, 5);
  std::vector<float> weights(300);
  for (float& w : weights) w = rng.next() < 0.3f ? 0 : rng.next() * rng.next();
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (float u : {0.0f, 0.3f, 0x1.fffffep-1f}) {
    const std::vector<uint32_t> times = systematicMultiplicities(weights, 1000, u);
    EXPECT_EQ(std::accumulate(times.begin(), times.end(), 0u), 1000u);
    for (size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] == 0) {
        EXPECT_EQ(times[i], 0u);
      }
      EXPECT_LT(std::abs(double(times[i]) - 1000 * double(weights[i]) / total), 1.001);
    }
  }
  EXPECT_EQ(systematicMultiplicities(std::vector<float>{0, 0}, 5, 0.5f), (std::vector<uint32_t>{0, 0}));
}

} // namespace lambent::test::photons_test
