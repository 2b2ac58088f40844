// Light propagation volumes: what is conserved, what walls stop, and what stays when the grid moves on.
#include "engine/core/rng.h"
#include "frames.h"
#include "gi/plan/techniques.h"
#include "gi/volume/light_volume.h"

namespace lambent::test::light_volume_test {

class LightVolumeTest : public GatherTest {
 protected:
  LightVolumeTest() {
    settings.vpl.source = VplSource::Poisson;
    settings.vpl.visibility = VplVisibility::None;
    settings.gather.mode = GatherMode::Volume;
    settings.filter.on = false;
  }

  /// Lights all over the insides of a box, side² on each face, of radiance 1/π: they reflect 1 W/m².
  static std::vector<VirtualLight> shiningWalls(const vec3& lo, const vec3& hi, int side) {
    std::vector<VirtualLight> lights;
    for (int face = 0; face < 6; ++face)
      for (int i = 0; i < side * side; ++i) {
        const int axis = face / 2;
        vec3 at(0), normal(0);
        at[axis] = float(face % 2);
        normal[axis] = face % 2 ? -1.0f : 1.0f;
        at[(axis + 1) % 3] = (float(i % side) + 0.5f) / float(side);
        at[(axis + 2) % 3] = (float(i / side) + 0.5f) / float(side);
        const vec3 size = hi - lo;
        const float area = size[(axis + 1) % 3] * size[(axis + 2) % 3] / float(side * side);
        lights.push_back(lightAt(lo + at * size, normal, vec3(1 / kPi), area));
      }
    return lights;
  }

  /// Flux on its way after so many steps.
  vec3 flux(const HandScene& scene, std::span<const VirtualLight> lights, int steps) {
    PlacedScene world(passes, scene);
    LightVolume volume(passes);
    settings.lpv.steps = steps;
    volume.update({world.world(), lights, settings.lpv}, stats);
    return volume.fluxOnItsWay();
  }

  Settings settings;
  FrameStats stats;
};

/// Of all colours, with walls, holes and a block in the way, from every step to the next.
TEST_F(LightVolumeTest, FluxNeverGrows) {
  Room room;
  std::vector<VirtualLight> lights;
  Rng rng(3, Stream::Test, 0);
  for (int i = 0; i < 300; ++i) {
    const vec3 normal = sampleSphere(rng.next2());
    lights.push_back(lightAt(2.0f * rng.next3() - 1.0f, normal, rng.next3(), 0.01f));
  }
  for (const bool occlusion : {true, false}) {
    settings.lpv.occlusion = occlusion;
    PlacedScene world(passes, room.scene);
    LightVolume volume(passes);
    vec3 before(kInfinity);
    std::printf("flux on its way, W, %s:", occlusion ? "walls stop light" : "walls let light through");
    for (int steps = 0; steps <= 48; ++steps) {
      settings.lpv.steps = steps;
      volume.update({world.world(), lights, settings.lpv}, stats);
      const vec3 now = volume.fluxOnItsWay();
      if (steps % 8 == 0) std::printf(" %.5f", double(luminance(now)));
      for (int c = 0; steps == 0 && c < 3; ++c) EXPECT_NEAR(now[c], volume.fluxDeposited()[c], 1e-5f * now[c]);
      for (int c = 0; c < 3; ++c) EXPECT_LE(now[c], before[c] * (1 + 1e-6f)) << steps;
      EXPECT_GT(now.y, 0) << steps;
      before = now;
    }
    std::printf("\n");
    EXPECT_LT(before.y, 0.1f * volume.fluxDeposited().y);
  }
}

/// Until it reaches the rim of the grid.
TEST_F(LightVolumeTest, NothingIsLostOnTheWay) {
  HandScene scene;
  scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
  const VirtualLight light = lightAt(vec3(0.01f), glm::normalize(vec3(1, 2, 3)), vec3(1, 2, 3), 0.1f);
  settings.lpv.cells = 32;
  const vec3 sent = kPi * light.radiance * light.area;
  for (const VolumeLobes lobes : {VolumeLobes::Way, VolumeLobes::Face}) {
    settings.lpv.lobes = lobes;
    for (int steps : {0, 1, 2, 7, 14}) {
      const vec3 now = flux(scene, {&light, 1}, steps);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(now[c], sent[c], 1e-5f * sent[c]) << steps;
    }
  }
}

/// A light that faces a wall: lobes along faces' normals send to the sides what went ahead, all of it still arrives.
TEST_F(LightVolumeTest, LobesAlongFacesSpreadLight) {
  HandScene scene;
  scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
  scene.camera = cameraAt(vec3(0), vec3(1, 0, 0), kPi / 2, 64, 64); // it fills the wall at x = 1
  const GBuffer gbuffer = surfaces(scene);
  const VirtualLight light = lightAt(vec3(-0.9f, 0.03f, 0.03f), vec3(1, 0, 0), vec3(1), 0.2f);
  settings.lpv.steps = 256;
  double arrives[2];
  for (const VolumeLobes lobes : {VolumeLobes::Way, VolumeLobes::Face}) {
    settings.lpv.lobes = lobes;
    double& here = arrives[int(lobes)] = 0;
    for (const vec4& e : readTexture(*gathered(gbuffer, {&light, 1}, settings).irradiance)) here += e.y * 4 / 4096.0;
  }
  std::printf("of %.4f W reach the wall ahead %.4f, by lobes along faces %.4f\n", double(kPi) * 0.2, arrives[0],
              arrives[1]);
  EXPECT_NEAR(arrives[1] / arrives[0], 0.667, 0.02) << "as it was when the lobes were those of the paper";
}

/// Walls of 1 W/m² all around light each other with as much: what leaves them arrives, in all directions.
TEST_F(LightVolumeTest, AFurnaceIsEven) {
  HandScene scene;
  scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
  scene.camera = cameraAt(vec3(0, 0, 0.9f), vec3(0, 0, -1), 1.6f);
  const GBuffer gbuffer = surfaces(scene);
  settings.lpv.steps = 256;
  for (const int cells : {8, 16, 32}) {
    settings.lpv.cells = cells;
    const SurfaceLighting light = gathered(gbuffer, shiningWalls(vec3(-1), vec3(1), 64), settings);
    double sum = 0;
    float least = kInfinity, most = 0;
    const std::vector<vec4> texels = readTexture(*light.irradiance);
    for (const vec4& e : texels) sum += e.y, least = std::min(least, e.y), most = std::max(most, e.y);
    const double mean = sum / double(texels.size());
    std::printf("furnace of 1 W/m2, %d cells: mean %.3f, %.3f to %.3f\n", cells, mean, double(least), double(most));
    EXPECT_NEAR(mean, 1, 0.02);
    EXPECT_GT(least, 0.85f);
    EXPECT_LT(most, 1.1f);
  }
}

/// What one light sends out into a closed room arrives on its walls, whichever way the light faces.
TEST_F(LightVolumeTest, WhatIsSentArrives) {
  const vec3 ways[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const vec3& facing : {vec3(1, 0, 0), glm::normalize(vec3(1, -1, 1))}) {
    const VirtualLight light = lightAt(vec3(0.03f), facing, vec3(1), 0.2f);
    double arrives = 0;
    settings.lpv.steps = 256;
    for (const vec3& way : ways) { // each view fills one wall of 4 m²
      HandScene scene;
      scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
      scene.camera = cameraAt(vec3(0), way, kPi / 2, 64, 64);
      const GBuffer gbuffer = surfaces(scene);
      for (const vec4& e : readTexture(*gathered(gbuffer, {&light, 1}, settings).irradiance))
        arrives += e.y * 4 / 4096.0;
    }
    std::printf("of %.4f W arrive %.4f\n", double(kPi) * 0.2, arrives);
    EXPECT_NEAR(arrives, kPi * 0.2, 0.02 * kPi * 0.2);
  }
}

/// Two rooms with a wall without thickness between, wherever it stands in the cells and however it is turned.
TEST_F(LightVolumeTest, ADarkRoomBesideALitOneStaysDark) {
  applyTechnique(settings, "lpv");
  settings.smc.paths = 8;
  expectDarkBesideLit(settings, 0.0005);
}

/// A pole takes some of the light that goes its way, a wall all, and a wall with a hole lets some through.
TEST_F(LightVolumeTest, PolesAreNoWalls) {
  const auto through = [&](const std::function<void(HandScene&)>& add) {
    HandScene scene;
    scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
    add(scene);
    PlacedScene world(passes, scene);
    VolumeVisibility sights;
    RayCounts counts;
    sights.update(volumeGrid({.cells = 8}, scene.view(), {}), world.world(), true, counts);
    float least = 1; // of the openings across the middle
    for (int z = 1; z < 7; ++z)
      for (int y = 1; y < 7; ++y) least = std::min(least, sights.open()[sights.grid().index({3, y, z})].x);
    return least;
  };
  const auto material = [](HandScene& scene) { return scene.material(vec3(0.5f)); };
  EXPECT_EQ(through([](HandScene&) {}), 1);
  EXPECT_GT(through([&](HandScene& s) { s.box({-0.02f, -1, 0.1f}, {0.02f, 1, 0.14f}, material(s), false); }), 0.5f);
  EXPECT_EQ(through([&](HandScene& s) { s.quad({0.01f, -1, -1}, {0, 2, 0}, {0, 0, 2}, material(s)); }), 0);
}

TEST_F(LightVolumeTest, SightsThatAreKeptAreThoseThatWouldBeFound) {
  Room room;
  HandScene& scene = room.scene;
  const uint32_t block = uint32_t(scene.instances.size());
  scene.box(vec3(0.2f, -0.6f, 0.1f), vec3(0.5f, 0, 0.5f), 0, false);
  EmbreeQuery rays(scene.assets);
  GpuScene gpu(passes, scene.assets);
  LightSet none;
  VolumeVisibility kept;
  SceneView view = scene.view();
  rays.update(view, true);
  VolumeGrid grid;
  for (int frame = 0; frame < 6; ++frame) {
    view = scene.view();
    view.camera.worldFromView[3] = vec4(0.21f * float(frame), 0.1f, -0.17f * float(frame), 1);
    view.changes = {frame == 0, true, false, frame > 2, false};
    scene.move(frame > 2 ? block : kNone, {-0.2f, 0.15f, 0});
    view.instances = scene.instances;
    rays.update(view, true);
    const DirtyRegion moved(view);
    grid = volumeGrid({.cells = 16, .size = 2.4f}, view, grid);
    RayCounts asked, all;
    kept.update(grid, {view, gpu, rays, moved, none, 1}, true, asked);
    VolumeVisibility fresh;
    fresh.update(grid, {view, gpu, rays, moved, none, 1}, true, all);
    for (size_t i = 0; i < grid.size(); ++i) {
      const ivec3 at(int(i % 16), int(i / 16 % 16), int(i / 256));
      if (glm::any(glm::equal(at, ivec3(0))) || glm::any(glm::equal(at, ivec3(15)))) continue; // may know more
      ASSERT_EQ(kept.open()[i], fresh.open()[i]) << frame << " " << i;
      ASSERT_EQ(kept.sights()[i], fresh.sights()[i]) << frame << " " << i;
    }
    EXPECT_TRUE(frame == 0 || asked.occlusion < all.occlusion * 7 / 10) << frame;
  }
}

/// In a scene at rest a volume is made once; what moves is followed.
TEST_F(LightVolumeTest, IsMadeAnewOnlyForWhatChanges) {
  Room room;
  room.scene.lamp({0.3f, 0.6f, 0.4f}, vec3(2));
  applyTechnique(settings, "lpv");
  settings.smc.vpls = 256;
  Viewer gi(settings);
  SceneView view = room.scene.view();
  const Image first = nextFrame(gi, view);
  view.changes = kCameraChanged; // the camera's
  const FrameStats& again = gi.run(view);
  EXPECT_EQ(again.raysVolume.occlusion, 0u);
  EXPECT_EQ(again.raysRadiosity.occlusion, 0u);
  EXPECT_EQ(again.ms(StageId::Propagate), 0);
  EXPECT_EQ(gi.read(Buffer::Irradiance).pixels, first.pixels);
  room.scene.lights[0].intensity *= 2;
  view.changes = kLightsChanged;
  const FrameStats& brighter = gi.run(view);
  EXPECT_GT(brighter.ms(StageId::Propagate), 0);
  EXPECT_EQ(brighter.raysVolume.occlusion, 0u);
  const Image second = gi.read(Buffer::Irradiance);
  EXPECT_NEAR(meanLuminance(second), 2 * meanLuminance(first), 1e-3 * meanLuminance(first));
}

} // namespace lambent::test::light_volume_test
