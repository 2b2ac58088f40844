// The sequential sampler as a whole, on rooms with closed-form rays.
#include "engine/core/parallel.h"
#include "gi/vpl/smc.h"
#include "tests/support/comparator_world.h"

#include <numbers>

namespace lambent::test::smc_test {

/// A room 6×3×6 m with a block in it, a lamp, and a set to update.
struct Room {
  AnalyticQuery rays;
  LightSet lights;
  std::vector<InstanceView> instances{2};
  SceneView view;
  SmcSettings settings;
  VplSet set;
  VplUpdateLog log;

  Room() {
    rays.addBox({-3, 0, -3}, {3, 3, 3}, {vec3(0.7f, 0.6f, 0.5f)});
    rays.addBox({-0.5f, 0, -0.5f}, {0.5f, 1.5f, 0.5f}, {vec3(0.4f)});
    lights.punctual = {lampAt({2, 2.5f, 1}, 5)};
    instances[1].id = 1;
    view.instances = instances;
    view.camera = cameraAlong({-2.5f, 1.5f, 2.5f}, {1, -0.2f, -1}, 1);
    settings = {.vpls = 256, .points = 512, .warmup = 10};
  }
  VplChanges update(uint32_t seed = 1) {
    log = {};
    const VplChanges c = updateVpls(set, {view, rays, lights, settings, seed}, log);
    view.changes = kStill;
    return c;
  }
};

class Smc : public ::testing::Test {
 protected:
  Room room;
};

TEST_F(Smc, WarmsUpLessWhereRaysAreSlow) {
  for (const auto& [boxes, shortened, expected] : {std::tuple(0.0f, true, 40), std::tuple(24.0f, true, 40),
                                                   std::tuple(48.0f, true, 20), std::tuple(48.0f, false, 40)}) {
    Room fresh;
    fresh.view.rayWork = boxes;
    fresh.settings.warmup = 40;
    fresh.settings.shortWarmup = shortened;
    int iterations = 0;
    updateVpls(fresh.set, {fresh.view, fresh.rays, fresh.lights, fresh.settings, 1}, fresh.log,
               [&](int, int of) { iterations = of; });
    EXPECT_EQ(iterations, expected) << boxes;
  }
}

TEST(Mailboxes, LoseALightWhoseCarrierTurnedItAway) {
  const AnalyticQuery rays; // the carrier is too small to be met
  const CameraView camera = cameraAlong({0, 0, 6}, {0, 0, -1}, 1);
  for (const float side : {1.0f, -1.0f}) {
    Vpl v;
    v.normal = v.geometricNormal = {0, 0, side};
    v.mailbox = {0, 0, 5};
    v.alive = v.valid = true;
    RayCounts counts;
    const uint8_t carried[] = {1};
    verifyMailboxes({&v, 1}, rays, camera, {false, &kNothingMoved, carried}, counts);
    EXPECT_EQ(v.valid, side > 0);
  }
}

TEST(Mailboxes, AreNotSeenThroughThinWalls) {
  AnalyticQuery rays;
  rays.addPlane({0, 0, 0}, {0, 0, 1}, {});
  rays.addPlane({0, 0, -3}, {0, 0, 1}, {});
  for (const float eye : {6.0f, -2.0f}) { // before the wall and behind it
    Vpl v;                                // behind it
    v.position = {1, 0, -3};
    v.normal = v.geometricNormal = {0, 0, 1};
    v.mailbox = offsetPoint({0, 0, 0}, {0, 0, -1}, 1e-4f);
    v.alive = v.valid = true;
    RayCounts counts;
    verifyMailboxes({&v, 1}, rays, cameraAlong({0, 0, eye}, {0, 0, -eye}, 1), {true}, counts);
    EXPECT_EQ(v.valid, eye < 0);
  }
}

TEST(Visibility, LightsAreNotFoundThroughThinWalls) {
  AnalyticQuery rays;
  rays.addPlane({0, 0, 0}, {0, 0, 1}, {});
  VplSet set;
  set.slots.resize(1);
  Vpl& v = set.slots[0];
  v.position = {0, 0, -1e-4f}; // on something that touches the wall from behind, or nearly
  v.geometricNormal = glm::normalize(vec3(1, 0, 0.1f));
  v.alive = true;
  const VisiblePoint x{{4, 0, 3}, {-1, 0, 0}};
  RayCounts counts;
  verifyByPoints(set, rays, {&x, 1}, 1, 1, counts);
  EXPECT_EQ(counts.occlusion, 2u) << "they face each other";
  EXPECT_FALSE(v.valid);
}

TEST_F(Smc, FillsTheSetOnSurfaces) {
  const VplChanges c = room.update();
  EXPECT_EQ(c.alive, 256u);
  for (const Vpl& v : room.set.slots) {
    ASSERT_TRUE(v.alive);
    const vec3 a = glm::abs(v.position - vec3(0, 1.5f, 0));
    const vec3 b = glm::abs(v.position - vec3(0, 0.75f, 0)) - vec3(0.5f, 0.75f, 0.5f);
    const bool onRoom = std::abs(a.x - 3) < 1e-4f || std::abs(a.y - 1.5f) < 1e-4f || std::abs(a.z - 3) < 1e-4f;
    const bool onBlock = std::abs(maxComponent(b)) < 1e-4f;
    EXPECT_TRUE(onRoom || onBlock);
    EXPECT_TRUE(isFinite(v.radiance));
    EXPECT_GT(v.area, 0);
  }
}

TEST_F(Smc, IsByteIdenticalForAnyThreadCount) {
  std::vector<Vpl> first;
  for (int threads : {1, 2, 2}) {
    setThreadCount(threads);
    Room room;
    room.update();
    for (int i = 0; i < 5; ++i) {
      room.view.camera = cameraAlong({-2.5f + 0.1f * float(i), 1.5f, 2.5f}, {1, -0.2f, -1}, 1);
      room.view.changes.camera = true;
      room.update();
    }
    if (first.empty()) first = room.set.slots;
    expectSame(first, room.set.slots);
  }
  setThreadCount(0);
}

TEST_F(Smc, MovesAtMostTheBound) {
  room.settings.moves = 5;
  room.update();
  for (int i = 0; i < 20; ++i) {
    room.view.camera = cameraAlong({-2.5f, 1.5f, 2.5f}, {1, -0.2f, -1 + 0.05f * float(i)}, 1);
    room.view.changes.camera = true;
    const VplSet before = room.set;
    const VplChanges c = room.update();
    EXPECT_LE(c.movedSlots.size(), 5u);
    for (uint32_t s = 0; s < 256; ++s) {
      const bool listed = std::binary_search(c.movedSlots.begin(), c.movedSlots.end(), s);
      EXPECT_EQ(before.slots[s].id != room.set.slots[s].id, listed) << "slot " << s;
    }
  }
}

TEST_F(Smc, SurvivesFacingTheSky) {
  room.update();
  const VplSet before = room.set;
  room.view.camera = cameraAlong({0, 100, 0}, {0, 1, 0.1f}, 1);
  room.view.changes.camera = true;
  const VplChanges c = room.update();
  EXPECT_TRUE(c.movedSlots.empty());
  EXPECT_EQ(c.alive, 256u);
  for (size_t i = 0; i < before.slots.size(); ++i) EXPECT_EQ(before.slots[i].id, room.set.slots[i].id);
}

TEST_F(Smc, CameraCutLiftsTheBound) {
  // Two closed rooms: a jump from one to the other loses every VPL at once.
  room.rays.addBox({20, 0, -3}, {26, 3, 3}, {vec3(0.6f)});
  room.instances.resize(3);
  room.instances[2].id = 2;
  room.view.instances = room.instances;
  room.lights.punctual.push_back(lampAt({23, 2.5f, 0}, 5));
  room.update();
  room.view.camera = cameraAlong({21, 1.5f, 2}, {1, 0, -1}, 1);
  room.view.changes.camera = true;
  const VplChanges c = room.update();
  EXPECT_TRUE(c.burst);
  size_t there = 0;
  for (const Vpl& v : room.set.slots) there += v.alive && v.position.x > 10;
  EXPECT_GT(there, 240u);
  const VplChanges next = room.update();
  EXPECT_FALSE(next.burst);
}

TEST_F(Smc, LostVplsAreReplacedWithinTheBoundWhenTheCameraTurns) {
  room.update();
  for (Vpl& v : room.set.slots) { // hide a quarter of the set where nobody sees it
    if (&v - room.set.slots.data() < 64) v.position = vec3(50, 0, 0), v.mailbox = vec3(50, 0.1f, 0);
  }
  room.view.changes.camera = true;
  const VplChanges c = room.update();
  EXPECT_FALSE(c.burst);
  EXPECT_EQ(c.invalid, 64u);
  EXPECT_EQ(c.movedSlots.size(), 16u);
}

TEST_F(Smc, ALossOfALargePartIsMadeUpAtOnce) {
  room.update();
  for (uint32_t s = 0; s < 115; ++s) { // 45 %
    Vpl& v = room.set.slots[s];
    v.position = vec3(50, 0, 0), v.mailbox = vec3(50, 0.1f, 0);
  }
  room.view.changes.camera = true;
  const VplSet before = room.set;
  const VplChanges c = room.update();
  EXPECT_EQ(c.invalid, 115u);
  EXPECT_GE(c.movedSlots.size(), 100u);
  for (uint32_t s = 115; s < 256; ++s) EXPECT_EQ(room.set.slots[s].id, before.slots[s].id) << "what is seen stays";
}

TEST_F(Smc, OneVpl) {
  room.settings.vpls = 1;
  for (int i = 0; i < 5; ++i) {
    const VplChanges c = room.update();
    EXPECT_EQ(c.alive, 1u);
    EXPECT_TRUE(std::isfinite(room.set.slots[0].area) && room.set.slots[0].area > 0);
  }
}

TEST_F(Smc, NoLightAndLightInsideAClosedBox) {
  Room dark;
  dark.lights.punctual.clear();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(dark.update().alive, 0u); // nothing brings light: no VPL
  Room boxed;
  boxed.lights.punctual[0].position = {0, 0.7f, 0}; // inside the block
  for (int i = 0; i < 3; ++i) EXPECT_EQ(boxed.update().alive, 0u);
}

TEST_F(Smc, LightSwitchedOffTakesEffectAtOnceAndBackOn) {
  room.update();
  room.lights.punctual.clear();
  room.view.changes.lights = true;
  room.update();
  for (const Vpl& v : room.set.slots) EXPECT_EQ(v.radiance, vec3(0));
  room.lights.punctual.resize(1);
  room.lights.punctual[0].position = {-2, 2, -2};
  room.view.changes.lights = true;
  room.update();
  float sum = 0;
  for (const Vpl& v : room.set.slots) sum += luminance(v.radiance);
  EXPECT_GT(sum, 0);
}

TEST_F(Smc, UnchangedWorldReestimatesOnlyCandidates) {
  room.update();
  room.update();
  EXPECT_EQ(room.log.relit, 0u);
  room.view.changes.lights = true;
  room.update();
  EXPECT_EQ(room.log.relit, 256u);
}

TEST_F(Smc, KeptValuesEqualEstimatingAgain) {
  room.update();
  for (int i = 0; i < 3; ++i) room.update();
  std::vector<Vpl> again = room.set.slots;
  relight(again, room.rays, room.lights, room.settings.paths, room.settings.bounces, 1, room.set.cells);
  for (size_t i = 0; i < again.size(); ++i) EXPECT_EQ(again[i].radiance, room.set.slots[i].radiance);
}

TEST_F(Smc, VplsRideOnMovingObjects) {
  room.update();
  const VplSet before = room.set;
  const mat4 step = mat4(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0), vec4(0.25f, 0, 0, 1));
  room.instances[1].worldFromObjectBefore = mat4(1);
  room.instances[1].worldFromObject = step;
  room.instances[1].moved = true;
  room.instances[1].boundsWorld = {{-0.25f, 0, -0.5f}, {0.75f, 1.5f, 0.5f}};
  room.instances[1].boundsWorldBefore = {{-0.5f, 0, -0.5f}, {0.5f, 1.5f, 0.5f}};
  room.view.changes.geometry = true;
  room.settings.moves = 0; // keep everyone
  const VplChanges c = room.update();
  size_t carried = 0;
  for (size_t i = 0; i < before.slots.size(); ++i) {
    const vec3 d = room.set.slots[i].position - before.slots[i].position;
    if (before.slots[i].instance == 1) {
      EXPECT_NEAR(d.x, 0.25f, 1e-5);
      EXPECT_TRUE(std::binary_search(c.movedSlots.begin(), c.movedSlots.end(), uint32_t(i)));
      ++carried;
    } else {
      EXPECT_EQ(d, vec3(0));
    }
  }
  EXPECT_GT(carried, 0u);
}

TEST_F(Smc, VplsOfARemovedObjectGoWithIt) {
  room.instances[0].id = 7; // ids are not indices
  room.update();
  const VplSet before = room.set;
  AnalyticQuery empty;
  empty.addBox({-3, 0, -3}, {3, 3, 3}, {vec3(0.7f, 0.6f, 0.5f)});
  room.rays = empty;
  const Aabb block[] = {{{-0.5f, 0, -0.5f}, {0.5f, 1.5f, 0.5f}}};
  room.view.addedOrRemoved = block;
  room.view.instances = std::span(room.instances).first(1);
  room.view.changes.instances = true;
  room.update();
  size_t stayed = 0, gone = 0;
  for (size_t i = 0; i < before.slots.size(); ++i) {
    if (before.slots[i].instance == 1)
      gone += room.set.slots[i].id != before.slots[i].id;
    else
      stayed += room.set.slots[i].id == before.slots[i].id;
    EXPECT_EQ(room.set.slots[i].instance, 7u);
  }
  EXPECT_GT(gone, 0u);
  EXPECT_GT(stayed, before.slots.size() * 3 / 4);
}

TEST_F(Smc, NumberOfVplsMayChangeBetweenFrames) {
  room.update();
  for (int n : {64, 300, 1, 128}) {
    room.settings.vpls = n;
    room.update();
    room.update();
    EXPECT_EQ(room.set.slots.size(), size_t(n));
    EXPECT_GE(room.update().alive, uint32_t(n) * 9 / 10) << n;
  }
}

/// Steradians of a lamp's falloff, so that its flux is that times its intensity.
double beamOf(const LightView& lamp) {
  if (lamp.type == LightType::Point) return 4 * std::numbers::pi;
  // glTF's spot: clamp((c - outer)/(inner - outer))² about the axis; between the two its mean is a third.
  const double inner = lamp.innerConeCos, outer = lamp.outerConeCos;
  return 2 * std::numbers::pi * (1 - inner + (inner - outer) / 3);
}

/// Light of sets in an empty room over what it must be. All of a lamp's flux Φ meets a wall, and so does what each
/// bounce leaves of it: ∫ L dA = (ρ + ρ² + … + ρ^B) Φ/π.
Mean shareOfTheRoomsLight(const LightView& lamp, uint32_t seeds) {
  std::vector<double> shares;
  for (uint32_t seed = 1; seed <= seeds; ++seed) {
    Room room;
    room.rays = {};
    room.rays.addBox({-3, 0, -3}, {3, 3, 3}, {vec3(0.6f)});
    room.lights.punctual[0] = lamp;
    room.settings = {.vpls = 512, .points = 512, .warmup = 30};
    room.update(seed);
    double set = 0, truth = 0;
    for (const Vpl& v : room.set.slots) set += double(luminance(v.radiance)) * v.area;
    for (int bounce = 1; bounce <= room.settings.bounces; ++bounce)
      truth += std::pow(0.6, bounce) * double(luminance(lamp.intensity)) * beamOf(lamp) / std::numbers::pi;
    shares.push_back(set / truth);
  }
  return meanOf(shares);
}

TEST_F(Smc, NoVplReflectsMoreThanTheLampsSend) {
  room.view.boundsWorld = {{-3, 0, -3}, {3, 3, 3}};
  placeVpls(VplSource::Smc, room.set, {room.view, room.rays, room.lights, room.settings, 1}, room.log);
  const float lamps = 4 * kPi * luminance(room.lights.punctual[0].intensity); // W
  EXPECT_NEAR(room.set.mostFlux, lamps * float(room.settings.bounces), 1e-3f * lamps);
  room.set.slots[0].radiance = vec3(1e6f);
  const std::vector<VirtualLight> lights = lightsOf(room.set);
  EXPECT_NEAR(kPi * luminance(lights[0].radiance) * lights[0].area, room.set.mostFlux, 1e-3f * room.set.mostFlux);
  for (size_t i = 1; i < lights.size(); ++i) ASSERT_EQ(lights[i].radiance, room.set.slots[i].radiance);
}

TEST_F(Smc, TheSetCarriesTheRoomsLight) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  // The set spreads VPLs apart, where the nearest neighbour alone would find 35 % too much light.
  EXPECT_TRUE(agrees(shareOfTheRoomsLight(lampAt({0.3f, 1.5f, -0.2f}, 5), 8), 1, 0.002));
}

TEST_F(Smc, ChoosingBrightVplsDoesNotMakeTheRoomBrighter) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  // A narrow spot: most of the room is lit by rare paths through a small patch, so estimates are noisy, and a set that
  // kept what looks bright by the estimate it renders with would carry 45 % too much.
  LightView spot = lampAt({0, 2.9f, 0}, 50);
  spot.type = LightType::Spot;
  spot.direction = glm::normalize(vec3(0.1f, -1, 0));
  spot.outerConeCos = std::cos(0.35f);
  spot.innerConeCos = std::cos(0.2f);
  EXPECT_TRUE(agrees(shareOfTheRoomsLight(spot, 12), 1, 0.015));
}

/// A lamp in the middle of a sphere lights all of it alike, E = I/R², and so does every bounce: L = (ρ + ρ² + … + ρ^B)
/// I/(π R²) everywhere, and πL falls on any plane anywhere inside.
TEST_F(Smc, WhiteFurnaceOfASphere) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  constexpr float kRadius = 2, kAlbedo = 0.6f, kIntensity = 5;
  std::vector<SurfaceHit> planes;
  for (const vec3& at : {vec3(0), vec3(0.6f, -0.5f, 0.4f)})
    for (const vec3& normal : {vec3(0, 1, 0), vec3(0, 0, -1), vec3(-0.6f, 0.48f, 0.64f), vec3(0.6f, -0.48f, -0.64f)}) {
      SurfaceHit plane;
      plane.t = 1;
      plane.position = at;
      plane.normal = plane.geometricNormal = normal;
      planes.push_back(plane);
    }
  std::vector<std::vector<double>> shares(planes.size());
  std::vector<double> ofAll; // mean over the planes
  for (uint32_t seed = 1; seed <= 18; ++seed) {
    Room room;
    room.rays = {};
    room.rays.addSphere(vec3(0), kRadius, {vec3(kAlbedo)});
    room.lights.punctual[0].position = vec3(0);
    room.lights.punctual[0].intensity = vec3(kIntensity);
    room.view.camera = cameraAlong({-1, 0.3f, 0.8f}, {1, 0, -0.5f}, 1);
    room.settings.bounces = int(seed % 3) + 1;
    room.update(seed);
    double bounces = 0;
    for (int bounce = 1; bounce <= room.settings.bounces; ++bounce) bounces += std::pow(double(kAlbedo), bounce);
    const double radiance = bounces * double(kIntensity) / (std::numbers::pi * double(kRadius * kRadius));
    for (const Vpl& v : room.set.slots) ASSERT_NEAR(v.radiance.x / radiance, 1, 1e-4) << room.settings.bounces;
    GatherSettings exact;
    exact.disk = 0;
    RayCounts counts;
    const std::vector<vec3> irradiance = irradianceByRays(room.rays, planes, lightsOf(room.set), exact, counts);
    ofAll.push_back(0);
    for (size_t i = 0; i < planes.size(); ++i) {
      shares[i].push_back(double(irradiance[i].x) / (std::numbers::pi * radiance));
      ofAll.back() += shares[i].back() / double(planes.size());
    }
  }
  for (size_t i = 0; i < planes.size(); ++i) EXPECT_TRUE(agrees(meanOf(shares[i]), 1, 0.006)) << "plane " << i;
  EXPECT_TRUE(agrees(meanOf(ofAll), 1, 0.0025));
}

} // namespace lambent::test::smc_test
