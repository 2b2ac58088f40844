// Direct light of emissive surfaces by patches (paper 4) against closed forms and against a thousand rays per pixel.
#include "area_lights.h"
#include "engine/core/parallel.h"
#include "engine/trace/embree_query.h"
#include "gi/direct/area_visibility.h"
#include "gi/lighting/area_lobe.h"

namespace lambent::test::area_light_test {

TEST_F(AreaLightTest, IsExactWhereNothingIsBetween) {
  LampScene scene;
  const Image image = irradianceOf(scene);
  const AreaLights lights = areaLights(collectLights(scene.view()));
  int floor = 0;
  for (const auto [x, y] : Pixels(96, 64)) {
    const CameraRay ray = pixelRay(scene.camera, x, y);
    const float t = -ray.origin.y / ray.direction.y;
    const vec3 at = ray.origin + ray.direction * t;
    if (t <= 0 || std::abs(at.x) > 9 || at.z < -9) continue;
    const vec3 expected = unshadowed(lights, lights.lights[0], at, vec3(0, 1, 0));
    if (glm::distance(image.at(x, y), vec3(0)) == 0) continue; // the lamp is in the way
    ASSERT_NEAR(image.at(x, y).x, expected.x, 2e-3f * expected.x) << x << ' ' << y;
    ASSERT_NEAR(image.at(x, y).z, expected.z, 2e-3f * expected.z);
    ++floor;
  }
  EXPECT_GT(floor, 3000);
  EXPECT_LT(stats.areaFragments, 1500u) << "of 6144 pixels";
}

/// Floors of metal and of a dielectric under the lamp: pixel by pixel what the CPU makes of the table, and on the whole
/// the integral of the lobe over the lamp.
TEST_F(AreaLightTest, GlossyFloorsMirrorTheLamp) {
  for (const auto& [albedo, roughness, metalness] :
       {std::tuple(vec3(0.9f, 0.6f, 0.2f), 0.3f, 1.0f), std::tuple(vec3(0.2f, 0.5f, 0.8f), 0.35f, 0.0f),
        std::tuple(vec3(0.9f, 0.6f, 0.2f), 0.6f, 0.7f)}) {
    LampScene scene;
    Material& floor = scene.assets.materials[0];
    floor.baseColor = albedo;
    floor.roughness = roughness;
    floor.metalness = metalness;
    scene.camera = cameraAt(vec3(0, 0.7f, 2.5f), vec3(0, 0, 0.4f), 1.2f, 48, 32);
    const Image image = radianceOf(scene);
    const AreaLights lights = areaLights(collectLights(scene.view()));
    const AreaPiece& lamp = lights.pieces.at(0);
    Image onCpu(48, 32), integrated(48, 32), drawn(48, 32);
    int seen = 0;
    for (const auto [x, y] : Pixels(48, 32)) {
      const CameraRay ray = pixelRay(scene.camera, x, y);
      const vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y), up(0, 1, 0);
      if (ray.direction.y >= 0 || std::abs(at.x) > 9 || at.z < -9) continue;
      const Receiver r = makeReceiver(up, -glm::normalize(ray.direction), albedo, plainFinish(roughness, metalness));
      const vec3 lambert = unshadowed(lights, lights.lights[0], at, up) * r.diffuse / kPi;
      onCpu.at(x, y) = lambert + lobeRadiance(lobeTable(), lamp, at, r);
      integrated.at(x, y) = lambert;
      constexpr int kSteps = 24;
      for (int i = 0; i < kSteps * kSteps; ++i) {
        const vec3 to = vec3(-0.4f + 0.8f * (float(i % kSteps) + 0.5f) / kSteps, 2,
                             -0.3f + 0.6f * (float(i / kSteps) + 0.5f) / kSteps);
        const vec3 way = to - at, towardsLight = glm::normalize(way);
        const float solid = 0.48f / (kSteps * kSteps) * towardsLight.y / glm::dot(way, way);
        integrated.at(x, y) += vec3(5, 4, 3) * glossyReflectance(r, towardsLight, 0) * (solid * towardsLight.y);
      }
      drawn.at(x, y) = image.at(x, y);
      ++seen;
    }
    EXPECT_GT(seen, 800);
    EXPECT_LT(relativeRmse(drawn, onCpu), 0.002) << roughness;
    EXPECT_LT(relativeRmse(drawn, integrated), roughness < 0.4f ? 0.02 : 0.06) << roughness;
    EXPECT_NEAR(meanLuminance(drawn) / meanLuminance(integrated), 1, 0.01) << roughness;
  }
}

/// With a texture that is white all over, a lamp is what it is without.
TEST_F(AreaLightTest, GlossyFloorsMirrorTexturedLamps) {
  LampScene scene;
  scene.assets.materials[0].roughness = 0.3f;
  scene.assets.materials[0].metalness = 1;
  scene.camera = cameraAt(vec3(0, 0.7f, 2.5f), vec3(0, 0, 0.4f), 1.2f, 48, 32);
  const Image whole = radianceOf(scene);
  scene.assets.materials[1].emissiveTexture = scene.texture(1, {u8vec4(255)}, false);
  EXPECT_LT(relativeRmse(radianceOf(scene), whole), 1e-4);
}

TEST_F(AreaLightTest, ShadowsAreThoseOfAThousandRays) {
  for (int what = 0; what < 5; ++what) {
    LampScene scene;
    const uint32_t white = scene.material(vec3(0.7f));
    if (what == 0) scene.box({-0.3f, 0.6f, -0.3f}, {0.3f, 0.7f, 0.3f}, white, false); // a plate in the air
    if (what == 1) scene.box({0.2f, 0, 0.2f}, {0.23f, 1.2f, 0.23f}, white, false);    // a pole
    if (what == 2)
      for (int i = 0; i < 8; ++i) // a fence
        scene.box({-0.8f + 0.2f * float(i), 0, 0.3f}, {-0.74f + 0.2f * float(i), 0.7f, 0.33f}, white, false);
    if (what == 3) scene.box({-1.2f, 0, -0.5f}, {-0.2f, 1.99f, 0.5f}, white, false); // reaches the lamp
    if (what == 4)
      for (int i = 0; i < 80; ++i) { // leaves
        const vec3 at =
            additiveRecurrence3(uint32_t(i), vec3(0.5f)) * vec3(1.4f, 0.3f, 1.0f) + vec3(-0.7f, 0.8f, -0.5f);
        const float turn = 2.4f * float(i);
        scene.quad(at, 0.08f * vec3(std::cos(turn), 0.3f, std::sin(turn)),
                   0.08f * vec3(-std::sin(turn), 0, std::cos(turn)), white);
      }
    const Image image = irradianceOf(scene), traced = tracedOf(scene);
    EXPECT_LT(relativeRmse(image, traced), what == 2 || what == 4 ? 0.035 : 0.02) << what;
    EXPECT_NEAR(meanLuminance(image) / meanLuminance(traced), 1, what == 3 ? 1.0 / 128 : 0.003)
        << what << ": rays know the block's edge, which is everywhere the same on the lamp, to 1/64 of it";
    EXPECT_LT(stats.areaFragments, 96u * 64u * 3 / 4) << what;
    EXPECT_LT(stats.raysArea.occlusion, 96u * 64u * 64u * 6 / 10) << what;
  }
}

TEST_F(AreaLightTest, LampsOfUnlikeSizeAndColour) {
  LampScene scene(vec3(4, 0, 0));
  scene.quad(vec3(1.2f, 1.0f, -0.02f), vec3(0.04f, 0, 0), vec3(0, 0, 0.04f), scene.material(vec3(0), vec3(0, 0, 900)));
  const uint32_t white = scene.material(vec3(0.7f));
  scene.box({0.3f, 0.3f, -0.3f}, {0.7f, 0.5f, 0.3f}, white, false);
  const Image image = irradianceOf(scene), traced = tracedOf(scene);
  EXPECT_LT(relativeRmse(image, traced), 0.06);
  for (int c = 0; c < 3; c += 2) {
    double a = 0, b = 0;
    for (size_t i = 0; i < image.pixels.size(); ++i) a += image.pixels[i][c], b += traced.pixels[i][c];
    EXPECT_NEAR(a / b, 1, 0.01) << c;
  }
}

TEST_F(AreaLightTest, ManyLampsShareTheRays) {
  LampScene scene(vec3(0.1f));
  const uint32_t lamp = scene.material(vec3(0), vec3(60)), white = scene.material(vec3(0.7f));
  for (int i = 0; i < 49; ++i)
    scene.quad(vec3(-3 + float(i % 7), 2.5f, -3 + float(i / 7)), vec3(0.1f, 0, 0), vec3(0, 0, 0.1f), lamp);
  scene.box({-0.5f, 0, -0.5f}, {0.5f, 0.8f, 0.5f}, white, false);
  const Image image = irradianceOf(scene), traced = tracedOf(scene, 4);
  EXPECT_LT(relativeRmse(image, traced), 0.05);
  EXPECT_NEAR(meanLuminance(image) / meanLuminance(traced), 1, 0.005);
}

/// Lamps behind a wall that outshine the one before it, which is due less than one ray beside them.
TEST_F(AreaLightTest, HiddenLampsDoNotTakeTheRaysOfOthers) {
  for (const int hidden : {1, 40}) {
    LampScene scene;
    const uint32_t white = scene.material(vec3(0.7f));
    scene.box({-2.1f, -1, -20}, {-2, 20, 20}, white, false);
    scene.box({0.2f, 0, 0.2f}, {0.4f, 0.8f, 0.4f}, white, false); // throws a shadow here
    const uint32_t bright = scene.material(vec3(0), vec3(0, 4e4f, 0) / float(hidden));
    for (int i = 0; i < hidden; ++i)
      scene.quad(vec3(-3, 1, 0.15f * float(i - hidden / 2)), vec3(0, 0.1f, 0), vec3(0, 0, 0.1f), bright);
    Image image = irradianceOf(scene), traced = tracedOf(scene, 16);
    for (size_t i = 0; i < image.pixels.size(); ++i)
      if (traced.pixels[i].y > traced.pixels[i].x) image.pixels[i] = traced.pixels[i] = vec3(0); // beyond the wall
    EXPECT_GT(meanLuminance(traced), 0.05);
    EXPECT_NEAR(meanLuminance(image) / meanLuminance(traced), 1, 0.01) << hidden << ": without, up to a third is lost";
    EXPECT_LT(relativeRmse(image, traced), 0.045) << hidden;
  }
}

/// The plane of a lamp behind a wall crosses what is lit here: on one side of it the lamp would bring light, were there
/// no wall, on the other not. The picture is that without it, whatever its strength.
TEST_F(AreaLightTest, HiddenLampsLeaveNoTraceOfTheirPlanes) {
  Image without;
  for (const float strength : {0.0f, 10.0f, 1000.0f}) {
    LampScene scene;
    const uint32_t white = scene.material(vec3(0.7f));
    scene.box({-1.55f, -1, -20}, {-1.5f, 20, 20}, white, false);
    scene.box({0.2f, 0, 0.2f}, {0.4f, 0.8f, 0.4f}, white, false);
    if (strength > 0) scene.quad({-3, 0.5f, 0.1f}, {0, 1, 0}, {0.8f, 0, 0}, scene.material(vec3(0), vec3(strength)));
    const Image image = irradianceOf(scene);
    if (strength == 0) without = image;
    float most = 0;
    for (size_t i = 0; i < image.pixels.size(); ++i)
      if (image.pixels[i] != without.pixels[i])
        most = std::max(most, maxComponent(glm::abs(image.pixels[i] - without.pixels[i])));
    EXPECT_LT(most, 0.05 * meanLuminance(without)) << strength;
  }
}

/// A lamp a sixteenth as bright as another is on the border of two groups: a camera that sways makes it hop between
/// them where each frame begins anew, and with that the rays that all lamps get.
TEST_F(AreaLightTest, LampsKeepTheirGroupsWhileTheCameraMoves) {
  bool hidden = false; // the bright one
  const auto groupsAt = [&](float x, float radiance, AreaGroups& groups) {
    HandScene scene;
    if (hidden) scene.box({-2.1f, 1.8f, -0.4f}, {-1.3f, 2.1f, 0.4f}, scene.material(vec3(0.5f)), false);
    scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), scene.material(vec3(0.5f)));
    scene.quad(vec3(-2, 2, -0.3f), vec3(0.6f, 0, 0), vec3(0, 0, 0.6f), scene.material(vec3(0), vec3(10)));
    scene.quad(vec3(2, 2, -0.3f), vec3(0.6f, 0, 0), vec3(0, 0, 0.6f), scene.material(vec3(0), vec3(radiance)));
    scene.camera = cameraAt(vec3(x, 1.8f, 3), vec3(x, 0.2f, 0), 1.0f, 96, 64);
    PlacedScene placed(passes, scene);
    const SceneView view = scene.view();
    const LightSet emitters = collectLights(view);
    const World world = placed.world(emitters);
    SurfacePass surfacePass(passes);
    SurfaceReader reader;
    const GBuffer surfaces = surfacePass.run({world.gpu, world.view.camera, false});
    RayCounts counts;
    return groups.of(areaLights(emitters), world.rays, reader.read(surfaces), counts);
  };
  AreaGroups kept;
  const std::vector<AreaLights> alike = groupsAt(0, 10, kept);
  ASSERT_EQ(alike.size(), 1u);
  const float border = 10 * alike[0].lights.at(0).brought / alike[0].lights.at(1).brought / 16;
  kept.forget();
  int hops = 0, hopsAnew = 0, before = -1, beforeAnew = -1;
  for (int frame = 0; frame < 12; ++frame) {
    AreaGroups anew;
    const float x = frame % 2 ? 0.1f : -0.1f;
    groupsAt(x, border, kept);
    groupsAt(x, border, anew);
    hops += frame > 0 && kept.bands()[1] != before;
    hopsAnew += frame > 0 && anew.bands()[1] != beforeAnew;
    before = kept.bands()[1], beforeAnew = anew.bands()[1];
  }
  EXPECT_EQ(hops, 0);
  EXPECT_EQ(hopsAnew, 11);
  groupsAt(0, 0.2f * border, kept); // well beyond
  EXPECT_EQ(kept.bands()[1], 1);
  hidden = true;
  groupsAt(0, 0.2f * border, kept);
  EXPECT_EQ(kept.bands()[1], 1) << "whatever becomes of the other";
  hidden = false;
  groupsAt(0, 5 * border, kept);
  EXPECT_EQ(kept.bands()[1], 0);
}

/// Fragments of many sizes meet along a shadow's edge: no block of the picture may be smeared. (Fragments that are not
/// held to finer ones beside them: the worst block is off by a tenth of the light and more.)
TEST_F(AreaLightTest, ShadowEdgesHoldInEveryBlock) {
  HandScene scene;
  const uint32_t white = scene.material(vec3(0.7f));
  scene.box({-3, 0, -3}, {3, 2.7f, 3}, white, true);
  scene.box({-1, 0, -1.2f}, {-0.4f, 1, -0.6f}, white, false);
  scene.box({0.5f, 0.5f, -1}, {1.3f, 0.6f, -0.2f}, white, false);
  scene.box({0.2f, 0, 0.6f}, {0.25f, 1.2f, 0.65f}, white, false);
  scene.quad({-0.05f, 2.4f, -0.05f}, {0.1f, 0, 0}, {0, 0, 0.1f}, scene.material(vec3(0), vec3(500)));
  scene.camera = cameraAt(vec3(0, 1.9f, 2.8f), vec3(0, 0.3f, -0.8f), 1.0f, 640, 360);
  const Image image = irradianceOf(scene);
  settings.area.refinement = AreaRefinement::Neighbours; // asks all rays
  settings.multires.depth = 0;                           // at every pixel
  settings.area.rays = 64;
  const Image every = irradianceOf(scene);
  const double mean = meanLuminance(every);
  double worst = 0;
  for (int y = 0; y < 360; y += 12)
    for (int x = 0; x < 640; x += 16) {
      double sum = 0;
      for (const auto [u, v] : Pixels({x, y}, {x + 16, y + 12})) {
        const double off = luminance(glm::abs(image.at(u, v) - every.at(u, v))) / mean;
        sum += off * off / (12 * 16);
      }
      worst = std::max(worst, std::sqrt(sum));
    }
  std::printf("RMSE %.2f %% of the mean, in the worst block of 16 x 12 pixels %.1f %%\n",
              100 * relativeRmse(image, every), 100 * worst);
  EXPECT_LT(relativeRmse(image, every), 0.01);
  EXPECT_LT(worst, 0.06);
}

TEST_F(AreaLightTest, AClosedBoxStaysBlack) {
  LampScene scene;
  scene.box(vec3(-1, 0.001f, -1), vec3(1, 1, 1), scene.material(vec3(0.7f)), true);
  scene.camera = cameraAt(vec3(0.5f, 0.5f, 0.9f), vec3(0, 0.3f, 0), 1.2f, 96, 64);
  EXPECT_EQ(meanLuminance(irradianceOf(scene)), 0);
}

/// A light that touches a wall, one seen edge-on, one behind a pane that is not cut out.
TEST_F(AreaLightTest, AtWallsOnEdgeAndBehindGlass) {
  LampScene scene;
  const uint32_t white = scene.material(vec3(0.7f)), lamp = scene.material(vec3(0), vec3(5));
  scene.quad(vec3(-2, 0, -1), vec3(4, 0, 0), vec3(0, 3, 0), white);                // wall at z = −1, faces +z
  scene.quad(vec3(-1.5f, 0.5f, -1), vec3(0, 0.5f, 0), vec3(0, 0, 0.5f), lamp);     // stands on it, faces −x
  scene.quad(vec3(1.5f, 0.5f, -0.999f), vec3(0.4f, 0, 0), vec3(0, 0.4f, 0), lamp); // lies on it
  scene.quad(vec3(1.4f, 0.4f, -0.9f), vec3(0.6f, 0, 0), vec3(0, 0.6f, 0), white);  // a pane before that one
  const Image image = irradianceOf(scene), traced = tracedOf(scene);
  for (const vec3& e : image.pixels) ASSERT_TRUE(isFinite(e) && e.x >= 0);
  EXPECT_LT(relativeRmse(image, traced), 0.04);
  EXPECT_NEAR(meanLuminance(image) / meanLuminance(traced), 1, 0.005);
}

/// Dim lamps that get less than a sample each stand for others like them, and one alone for itself, by as many samples
/// as were drawn.
TEST_F(AreaLightTest, DimLampsCountByTheSamplesThatWereDrawn) {
  for (const int lamps : {24, 1}) {
    LampScene scene(vec3(12));
    // Of 24 each brings a tenth of the bright one's, of which they share the rays; alone, a thirtieth.
    const uint32_t dim = scene.material(vec3(0), vec3(lamps > 1 ? 48 : 15));
    for (int i = 0; i < lamps; ++i) // far to the left
      scene.quad(vec3(-4.0f + 0.25f * float(i % 6), 2, -0.6f + 0.3f * float(i / 6)), vec3(0.2f, 0, 0), vec3(0, 0, 0.2f),
                 dim);
    scene.box({-0.9f, 1.6f, -0.8f}, {0.9f, 1.7f, 0.8f}, scene.material(vec3(0.7f)), false); // hides the bright one
    const Image traced = tracedOf(scene, 8);
    for (const auto& [rule, threshold] : {std::pair(AreaRefinement::SubFragments, 1), {AreaRefinement::Counts, 3}}) {
      settings.area.refinement = rule;
      settings.area.threshold = threshold;
      const Image image = irradianceOf(scene);
      double found = 0, expected = 0;
      for (const auto [x, y] : Pixels(96, 64)) {
        const CameraRay ray = pixelRay(scene.camera, x, y);
        const vec3 at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
        if (ray.direction.y >= 0 || std::abs(at.x) > 0.7f || std::abs(at.z) > 0.7f)
          continue; // umbra of the bright lamp
        found += double(image.at(x, y).x);
        expected += double(traced.at(x, y).x);
      }
      std::printf("%d dim lamps by rule %d: %.4f of their light\n", lamps, int(rule), found / expected);
      EXPECT_GT(expected, 1);
      EXPECT_NEAR(found / expected, 1, 0.05) << lamps << ' ' << int(rule);
    }
  }
}

// Patches that stay whole tell it, one by one: each asks sixteen samples, of which a dim lamp is due less than one.
TEST_F(AreaLightTest, DimLampsCountInWholePatchesToo) {
  LampScene scene(vec3(12));
  const uint32_t dim = scene.material(vec3(0), vec3(48));
  for (int i = 0; i < 24; ++i)
    scene.quad(vec3(-4.0f + 0.25f * float(i % 6), 2, -0.6f + 0.3f * float(i / 6)), vec3(0.2f, 0, 0), vec3(0, 0, 0.2f),
               dim);
  scene.box({-0.9f, 1.6f, -0.8f}, {0.9f, 1.7f, 0.8f}, scene.material(vec3(0.7f)), false);
  const AreaLights lights = areaLights(collectLights(scene.view()));
  EmbreeQuery rays(scene.assets);
  rays.update(scene.view());
  std::vector<float> depth(96 * 64, 0);
  std::vector<vec4> normal(depth.size(), vec4(0, 1, 0, 1));
  const vec3 forward = -vec3(scene.camera.worldFromView[2]);
  std::vector<glm::ivec2> patches;
  std::vector<float> expected;
  constexpr int kLevel = 3;
  for (const auto [x, y] : Pixels(96, 64)) { // of the floor alone
    const CameraRay ray = pixelRay(scene.camera, x, 63 - y);
    if (ray.direction.y >= 0) continue;
    const vec3 way = ray.direction * (-ray.origin.y / ray.direction.y), at = ray.origin + way;
    depth[size_t(y * 96 + x)] = scene.camera.near / glm::dot(way, forward);
    if (x % 8 != 4 || y % 8 != 4 || std::abs(at.x) > 2 || at.z < 0.5f || at.z > 2) continue; // umbra of the bright one
    patches.emplace_back(x / 8, y / 8);
    float all = 0, hidden = 0;
    for (const AreaLight& light : lights.lights) {
      const float brought = luminance(unshadowed(lights, light, at, vec3(0, 1, 0)));
      all += brought;
      if (&light == &lights.lights[0]) hidden = brought;
    }
    expected.push_back(1 - hidden / all);
  }
  const FrameSurfaces surfaces{96, 64, depth, normal, cameraBlock(scene.camera, 0)};
  const AreaVisibility visibility(rays, lights, surfaces, 16, AreaAims::Same);
  const std::vector<AreaSeen> seen = visibility.ofPatches(patches, kLevel);
  ASSERT_GT(patches.size(), 8u);
  float found = 0, wanted = 0;
  for (size_t i = 0; i < patches.size(); ++i) {
    EXPECT_NEAR(seen[i].visible.x / expected[i], 1, 0.1) << patches[i].x << ' ' << patches[i].y;
    found += seen[i].visible.x, wanted += expected[i];
  }
  EXPECT_NEAR(found / wanted, 1, 0.03);
}

// A patch whose middle lies above a lamp's plane is not dark for that: its lower half is lit.
TEST_F(AreaLightTest, LightEndsWhereTheLampsPlaneDoes) {
  HandScene scene;
  scene.quad(vec3(-2, 0, -1), vec3(4, 0, 0), vec3(0, 2, 0), scene.material(vec3(0.5f)));
  scene.quad(vec3(-1, 1, -0.95f), vec3(2, 0, 0), vec3(0, 0, 0.4f), scene.material(vec3(0), vec3(5)));
  for (int i = 0; i < 4; ++i) { // the plane's height within a patch
    scene.camera = cameraAt(vec3(0, 0.9f + 0.01f * float(i), 1), vec3(0, 0.9f + 0.01f * float(i), -1), 1.0f, 96, 64);
    const Image traced = tracedOf(scene), image = irradianceOf(scene);
    EXPECT_LT(relativeRmse(image, traced), 0.02) << i;
    float most = 0;
    for (const vec3& e : traced.pixels) most = std::max(most, e.x);
    int black = 0;
    for (size_t p = 0; p < traced.pixels.size(); ++p)
      black += traced.pixels[p].x > 0.01f * most && image.pixels[p].x == 0;
    EXPECT_EQ(black, 0) << i;
  }
}

TEST_F(AreaLightTest, TheGpuTracesTheSame) {
  LampScene scene;
  scene.box({-0.3f, 0.6f, -0.3f}, {0.3f, 0.7f, 0.3f}, scene.material(vec3(0.7f)), false);
  settings.area.tracer = AreaTracer::Cpu;
  const Image cpu = irradianceOf(scene);
  const FrameStats byCpu = stats;
  EXPECT_EQ(stats.areaTracer, "cpu");
  settings.area.tracer = AreaTracer::Gpu;
  const Image gpu = irradianceOf(scene);
  EXPECT_EQ(stats.areaTracer, "gpu");
  // Rays that graze an edge may tell otherwise: some of a hundred thousand.
  EXPECT_NEAR(double(stats.raysArea.occlusion), double(byCpu.raysArea.occlusion),
              0.005 * double(byCpu.raysArea.occlusion));
  EXPECT_NEAR(double(stats.areaFragments), double(byCpu.areaFragments), 0.005 * double(byCpu.areaFragments));
  EXPECT_LT(relativeRmse(gpu, cpu), 2e-3);
}

TEST_F(AreaLightTest, SaysTheSameForAnyNumberOfThreads) {
  LampScene scene;
  scene.box({-0.3f, 0.6f, -0.3f}, {0.3f, 0.7f, 0.3f}, scene.material(vec3(0.7f)), false);
  const Image a = irradianceOf(scene);
  setThreadCount(1);
  const Image b = irradianceOf(scene);
  setThreadCount(0);
  EXPECT_EQ(a.pixels, b.pixels);
}

} // namespace lambent::test::area_light_test
