// Surfaces with normal maps: what the G-buffer holds against rays, and light on them against closed forms.
#include "frames.h"
#include "gi/direct/soft_sampler.h"
#include "gi/vpl/smc.h"

namespace lambent::test::normal_map_test {

class NormalMapTest : public GatherTest {
 protected:
  NormalMapTest() {
    material = scene.material(vec3(0.5f));
    scene.normalMap(material, {0.4f, -0.3f, 0.8f});
    scene.camera = cameraAt(vec3(0, 4, 0), vec3(0), 1.0f);
  }
  /// A floor at y = 0; returns its mapped normal.
  vec3 floor() {
    scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), material);
    const u8vec4 texel = scene.assets.images[0].texels[0];
    const vec3 local = vec3(texel) / 127.5f - 1.0f;
    return glm::normalize(vec3(local.x, local.z, local.y)); // tangent x, bitangent z
  }
  vec3 at(int x, int y) const {
    const CameraRay ray = pixelRay(scene.camera, x, y);
    return ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
  }
  HandScene scene;
  uint32_t material;
  FrameStats of;
};

/// From in front, from behind, mirrored, and stretched; matt, and metal, which mirrors nobody into the surface.
TEST_F(NormalMapTest, MappedNormalsAreThoseOfRays) {
  scene.assets.images[0].texels.push_back({230, 140, 160, 255});
  scene.assets.images[0].width = 2;
  scene.assets.materials[material].normalScale = 0.7f;
  scene.quad({-4, -1, 0}, {2, 0, 0}, {0, 2, 0.5f}, material);
  scene.quad({0, -1, 0}, {-2, 0, 0}, {0, 2, 0.5f}, material);
  const Mesh mesh = scene.assets.meshes[0];
  scene.add(mesh, glm::translate(mat4(1), vec3(-1.8f, 0, 0)) * glm::scale(mat4(1), vec3(-1, 1, 1)));
  scene.add(mesh, glm::translate(mat4(1), vec3(7.5f, 0, 0)) * glm::scale(mat4(1), vec3(1.2f, 0.5f, 2)));
  scene.camera = cameraAt(vec3(0, 0.3f, 5), vec3(0), 1.0f);
  for (const float metalness : {0.0f, 1.0f}) {
    SCOPED_TRACE(metalness);
    scene.assets.materials[material].metalness = metalness;
    GBuffer frame = surfaces(scene);
    ASSERT_TRUE(frame.mappedNormal);
    const Image smooth = surfaceBuffer(Buffer::Normal, frame);
    frame.normal = frame.mappedNormal;
    const Image mapped = surfaceBuffer(Buffer::Normal, frame);
    const TracedScene traced(scene);
    int differ = 0, seen = 0, edges = 0, inwards = 0;
    for (const auto [x, y] : Pixels(mapped)) {
      const vec2 centre = (vec2(x, y) + 0.5f) / vec2(mapped.width, mapped.height);
      const SurfaceHit hit = surfacesAt(traced.rays, scene.camera, std::array{centre}, &traced.view)[0];
      if (!hit.valid()) continue;
      ++seen;
      differ += glm::length(mapped.at(x, y) - smooth.at(x, y)) > 0.1f;
      edges += glm::length(mapped.at(x, y) - hit.normal) > 3e-3f;
      const vec3 mirrored = glm::reflect(glm::normalize(hit.position - scene.camera.position()), mapped.at(x, y));
      inwards += glm::dot(mirrored, hit.geometricNormal) < 0;
    }
    EXPECT_GT(seen, 400);
    EXPECT_GT(differ, seen * 9 / 10);
    EXPECT_LE(edges, seen / 50) << "only at edges of texels and quads";
    if (metalness > 0)
      EXPECT_LE(inwards, seen / 50);
    else
      EXPECT_GT(inwards, seen / 5);
  }
}

TEST_F(NormalMapTest, DirectLightFallsOnTheMappedNormalAndNeverFromBelow) {
  const vec3 normal = floor();
  const vec3 sun = glm::normalize(vec3(-0.5f, -0.6f, 0.2f)), lamp(0.5f, 1.5f, 0.3f);
  scene.lights.push_back({.type = LightType::Directional, .direction = sun, .intensity = vec3(2)});
  scene.lights.push_back({.type = LightType::Point, .position = lamp, .intensity = vec3(10)});
  // Below the floor, in front of the slope: nothing stands between them on the way but the floor itself.
  scene.lights.push_back({.type = LightType::Point, .position = {3, -0.2f, 0}, .intensity = vec3(100)});
  Settings settings;
  settings.shadow = {.sunResolution = 512, .pointResolution = 512, .spotResolution = 512};
  settings.direct.soft = SoftLightBy::Maps;
  const Image image = directOf(passes, scene, {}, settings, of);
  for (const auto [x, y] : Pixels(image)) {
    const vec3 way = lamp - at(x, y);
    const float r2 = glm::dot(way, way);
    const float wanted =
        2 * std::max(0.0f, -glm::dot(normal, sun)) + 10 * std::max(0.0f, glm::dot(normal, way)) / (r2 * std::sqrt(r2));
    ASSERT_NEAR(image.at(x, y).y, wanted, 2e-3f * wanted + 1e-4f) << x << ' ' << y;
  }
}

TEST_F(NormalMapTest, VirtualLightsFallOnTheMappedNormalAndNeverFromBelow) {
  const vec3 normal = floor(), place(0.6f, 1.2f, -0.4f), facing = glm::normalize(vec3(-0.2f, -1, 0));
  constexpr float kArea = 0.02f;
  const GBuffer frame = surfaces(scene);
  const std::vector<VirtualLight> lights{lightAt(place, facing, vec3(3), kArea),
                                         lightAt({4, -0.3f, 0}, glm::normalize(vec3(-1, 0.2f, 0)), vec3(500), 1)};
  Settings settings;
  settings.gather.mode = GatherMode::Full;
  const Image image = read(Buffer::Irradiance, frame, {}, gathered(frame, lights, settings));
  for (const auto [x, y] : Pixels(image)) {
    const vec3 way = place - at(x, y);
    const float r2 = glm::dot(way, way);
    const float cosines = std::max(0.0f, glm::dot(normal, way)) * std::max(0.0f, -glm::dot(facing, way)) / r2;
    const float wanted = 3 * kArea * cosines / (r2 + kArea / kPi);
    ASSERT_NEAR(image.at(x, y).y, wanted, 3e-3f * wanted + 1e-6f) << x << ' ' << y;
  }
}

/// Slopes finer than a pixel: their light is the mean of what each gets, not that of their mean direction.
TEST_F(NormalMapTest, SlopesFinerThanAPixelGetTheirMeanLight) {
  TextureImage& map = scene.assets.images[0];
  map.width = map.height = 64;
  map.texels.clear();
  dvec3 mean(0);
  for (int i = 0; i < 64 * 64; ++i) {
    const vec2 phase = vec2(i % 64, i / 64) * (2 * kPi / 32);
    const vec3 slope = glm::normalize(vec3(0.8f * glm::sin(phase), 1));
    map.texels.push_back(u8vec4(glm::round((slope * 0.5f + 0.5f) * 255.0f), 77)); // alpha is the file's own affair
    const vec3 kept = glm::normalize(vec3(map.texels.back()) * (2 / 255.0f) - 1.0f);
    mean += dvec3(kept.x, kept.z, kept.y) / (64.0 * 64.0); // a floor's
  }
  scene.assets.materials[material].normalTexture.uvTransform = glm::mat3x3(300, 0, 0, 0, 300, 0, 0, 0, 1);
  scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), material);
  ASSERT_LT(glm::length(mean), 0.9);
  const vec3 sun = glm::normalize(vec3(-0.2f, -1, 0.1f)), place(0, 1000, 0);
  scene.lights.push_back({.type = LightType::Directional, .direction = sun, .intensity = vec3(2)});
  Settings settings;
  settings.shadow.sunResolution = 512;
  settings.direct.soft = SoftLightBy::Maps;
  settings.gather.mode = GatherMode::Full;
  const GBuffer frame = surfaces(scene);
  const std::vector<VirtualLight> lights{lightAt(place, vec3(0, -1, 0), vec3(1e6f), 1)};
  const Image direct = directOf(passes, scene, {}, settings, of),
              indirect = read(Buffer::Irradiance, frame, {}, gathered(frame, lights, settings));
  const auto meanOfImage = [](const Image& image) {
    double sum = 0;
    for (const vec3& p : image.pixels) sum += double(p.y) / double(image.pixels.size());
    return sum;
  };
  const double sunny = -2 * glm::dot(mean, dvec3(sun)), lit = mean.y;
  EXPECT_NEAR(meanOfImage(direct), sunny, 0.01 * sunny);
  EXPECT_NEAR(meanOfImage(indirect), lit, 0.01 * lit);
  // Where some face away from the sun, more than the length of their mean counts: a fit.
  for (const float angle : {60.0f, 75.0f}) {
    const vec3 towards(std::sin(glm::radians(angle)), std::cos(glm::radians(angle)), 0);
    scene.lights[0].direction = -towards;
    double wanted = 0;
    for (const u8vec4& t : map.texels) {
      const vec3 local = glm::normalize(vec3(t) * (2 / 255.0f) - 1.0f);
      wanted += 2 * std::max(0.0, double(glm::dot(towards, vec3(local.x, local.z, local.y)))) / (64.0 * 64.0);
    }
    EXPECT_NEAR(meanOfImage(directOf(passes, scene, {}, settings, of)), wanted, 0.05 * wanted) << angle;
  }
}

/// A sky of 1 brings π·(1 + n·up)/2 to a slope of an open floor: the rest of what it sees is the floor, which is
/// another's.
TEST_F(NormalMapTest, SoftLightFallsOnTheMappedNormal) {
  const vec3 normal = floor();
  scene.sky = vec3(1);
  const TracedScene traced(scene);
  const LightSet lights = softLightsOf(traced.lights, SoftParts::All);
  RayCounts counts;
  const SoftLight light = sampleSoftLight(
      {.rays = traced.rays, .lights = lights, .view = traced.view, .samples = 64, .more = {}, .normalMaps = true},
      counts);
  std::vector<float> pixels;
  for (const vec3& e : light.irradiance) pixels.push_back(e.y);
  const Mean mean = meanOf(pixels);
  EXPECT_NEAR(mean.mean, double(kPi) * 0.5 * (1 + double(normal.y)), 4 * mean.error + 1e-3);
}

/// Whole frames with and without: what the plan says, and that a scene without maps pays for nothing.
TEST_F(NormalMapTest, AreDrawnWhereTheSceneHasThem) {
  floor();
  scene.lamp({0.5f, 1.5f, 0.3f}, vec3(10));
  Settings settings;
  settings.smc = {.vpls = 16, .points = 64, .warmup = 1};
  const auto statsOf = [&](const HandScene& of, EffectMode mode) {
    settings.effects[EffectId::NormalMaps] = mode;
    GiFrame gi(settings, 1, {});
    const FrameStats stats = gi.run(of.view());
    EXPECT_EQ(gi.outputs().surfaces.mappedNormal != nullptr, stats.plan.on(EffectId::NormalMaps));
    return stats;
  };
  EXPECT_TRUE(statsOf(scene, EffectMode::Auto).plan.on(EffectId::NormalMaps));
  EXPECT_FALSE(statsOf(scene, EffectMode::Off).plan.on(EffectId::NormalMaps));
  EXPECT_FALSE(statsOf(Room().scene, EffectMode::Auto).plan.on(EffectId::NormalMaps));
}

} // namespace lambent::test::normal_map_test
