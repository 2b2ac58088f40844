// Glossy receivers on the GPU against the shared BRDF evaluated on the CPU, pixel by pixel.
#include "engine/trace/embree_query.h"
#include "gi/direct/direct_light.h"
#include "gi/direct/light_shadows.h"
#include "gi/reference/path_tracer.h"
#include "gl_fixture.h"
#include "shaders/shared/ggx.h"
#include "tests/support/images.h"
#include "tests/support/spread_lights.h"
#include "tests/support/statistics.h"

namespace lambent::test {

class GlossyTest : public GatherTest {
 protected:
  /// The floor of one material, seen askew so that views, lights and lobes differ from pixel to pixel.
  struct GlossyFloor : Floor {
    GlossyFloor(const vec3& albedo, float roughness, float metalness, bool orthographic = false) {
      Material& m = scene.assets.materials[0];
      m.baseColor = albedo;
      m.roughness = roughness;
      m.metalness = metalness;
      scene.camera = cameraAt(vec3(1, 2, 2.2f), vec3(0), 0.7f);
      if (orthographic) scene.camera.orthoHalfHeight = 1.2f;
    }
    Receiver receiverAt(int x, int y) const {
      const Material& m = scene.assets.materials[0];
      const vec3 towardsViewer = scene.camera.orthoHalfHeight > 0 ? vec3(scene.camera.worldFromView[2])
                                                                  : glm::normalize(scene.camera.position() - at(x, y));
      return makeReceiver({0, 1, 0}, towardsViewer, m.baseColor, m.roughness, m.metalness);
    }
  };

  GBuffer surfaces(const HandScene& scene, bool glossy = true) { return GatherTest::surfaces(scene, glossy); }
  Image indirectRadiance(const GBuffer& gbuffer, const SurfaceLighting& indirect) {
    return read(Buffer::Indirect, gbuffer, {}, indirect);
  }

  CompositePass compositePass{passes};
};

struct Finish {
  vec3 albedo;
  float roughness, metalness;
  bool orthographic = false;
};
const Finish kFinishes[] = {{vec3(0.9f, 0.6f, 0.2f), 0.3f, 1},       {vec3(0.2f, 0.5f, 0.8f), 0.3f, 0},
                            {vec3(0.2f, 0.5f, 0.8f), 0.6f, 0.4f},    {vec3(0), 0.4f, 0},
                            {vec3(0.9f, 0.6f, 0.2f), 0.1f, 1, true}, {vec3(0.5f), 1, 0}};

TEST_F(GlossyTest, OneVplOnAPlane) {
  const vec3 position(-0.6f, 0.9f, -1.2f), normal = glm::normalize(vec3(0.4f, -1, 0.6f)), radiance(4, 3, 2);
  constexpr float kArea = 0.05f;
  float brightest = 0; // lobe over Lambert
  for (const Finish& f : kFinishes) {
    const GlossyFloor floor(f.albedo, f.roughness, f.metalness, f.orthographic);
    const GBuffer gbuffer = surfaces(floor.scene);
    const std::vector lights{lightAt(position, normal, radiance, kArea)};
    const SurfaceLighting raw = gathered(gbuffer, lights, with(GatherMode::Full));
    const SurfaceLighting indirect = filterPass.run({gbuffer, raw, {}});
    const Image image = indirectRadiance(gbuffer, indirect);
    const Picture picture = compositePass.run({gbuffer, {}, indirect, vec3(0)});
    FrameResults results;
    results.surfaces = gbuffer;
    results.picture = picture;
    const Image beauty = readBuffer(Buffer::Beauty, results);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const vec3 d = position - floor.at(x, y), towardsLight = glm::normalize(d);
        const float r2 = glm::dot(d, d);
        const vec3 irradiance =
            radiance * (kArea * std::max(0.0f, -glm::dot(normal, towardsLight)) * towardsLight.y / (r2 + kArea / kPi));
        const Receiver receiver = floor.receiverAt(x, y);
        const vec3 lambert = irradiance * receiver.diffuse / kPi;
        const float spread = lobeSpread(GatherSettings{}.spread, kArea, -glm::dot(normal, towardsLight), r2);
        const vec3 lobe = irradiance * glossyReflectance(receiver, towardsLight, spread);
        for (int c = 0; c < 3; ++c) {
          const float wanted = lambert[c] + lobe[c];
          ASSERT_NEAR(image.at(x, y)[c], wanted, 3e-3f * wanted + 1e-6f)
              << x << ' ' << y << " roughness " << f.roughness;
          ASSERT_NEAR(beauty.at(x, y)[c], wanted, 3e-3f * wanted + 1e-6f) << x << ' ' << y;
        }
        brightest = std::max(brightest, lobe.x / std::max(irradiance.x / kPi, 1e-6f));
      }
  }
  EXPECT_GT(brightest, 10) << "the light's mirror image lies in the picture";
}

TEST_F(GlossyTest, InterleavedMeansTheSameAsFull) {
  const GlossyFloor floor(vec3(0.9f, 0.6f, 0.2f), 0.3f, 0.5f);
  const GBuffer gbuffer = surfaces(floor.scene);
  // The same light in every slot: each subset of 16 sees as much as all of them together.
  const std::vector<VirtualLight> lights(2048, lightAt({-0.6f, 0.9f, -1.2f}, {0, -1, 0}, vec3(1, 2, 3), 0.01f));
  const auto radianceOf = [&](GatherMode mode) {
    const SurfaceLighting raw = gathered(gbuffer, lights, with(mode));
    return indirectRadiance(gbuffer, filterPass.run({gbuffer, raw, {.on = false}}));
  };
  const Image full = radianceOf(GatherMode::Full), interleaved = radianceOf(GatherMode::Interleaved);
  for (size_t i = 0; i < full.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(interleaved.pixels[i][c], full.pixels[i][c], 2e-4f * full.pixels[i][c]) << i;
}

TEST_F(GlossyTest, FilterKeepsConstantsAndTheTintOfEachPixel) {
  // Two metals side by side on one plane: a constant in the filter's input must come out in each one's own colour.
  HandScene scene;
  const vec3 colors[2] = {{1, 0.7f, 0.3f}, {0.5f, 0.6f, 0.9f}};
  for (int i = 0; i < 2; ++i) {
    const uint32_t m = scene.material(colors[i]);
    scene.assets.materials[m].metalness = 1;
    scene.assets.materials[m].roughness = 0.5f;
    scene.quad({i ? 0.0f : -9.0f, -9, 0}, {9, 0, 0}, {0, 18, 0}, m);
  }
  scene.camera = cameraAt({0, 0, 3}, vec3(0), 1);
  const GBuffer gbuffer = surfaces(scene);
  const gl::Texture black("black", {.format = GL_RGBA32F, .width = 64, .height = 48}),
      constant("constant", {.format = GL_RGBA32F, .width = 64, .height = 48});
  black.clear();
  const float value[4] = {2, 3, 4, 1};
  glClearTexImage(constant.name(), 0, GL_RGBA, GL_FLOAT, value);
  for (const bool on : {true, false})
    for (const FilterKernel kernel : {FilterKernel::Separable, FilterKernel::Whole}) {
      const SurfaceLighting raw{&black, &constant, true};
      const Image image = indirectRadiance(gbuffer, filterPass.run({gbuffer, raw, {.on = on, .kernel = kernel}}));
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
          ASSERT_LT(glm::length(image.at(x, y) - colors[x >= 32] * vec3(2, 3, 4)), 4e-3f) << x << ' ' << y;
    }
}

TEST_F(GlossyTest, PunctualLightsAndEmissiveSamples) {
  const vec3 position(-0.6f, 0.9f, -1.2f), intensity(5, 4, 3);
  const vec3 sunDirection = glm::normalize(vec3(-0.3f, -0.7f, -0.8f)), sun(2, 2, 1);
  ShadowSettings shadow;
  shadow.sunResolution = shadow.pointResolution = shadow.spotResolution = 512;
  for (const Finish& f : kFinishes) {
    GlossyFloor floor(f.albedo, f.roughness, f.metalness, f.orthographic);
    floor.scene.lights.push_back({.type = LightType::Point, .position = position, .intensity = intensity});
    floor.scene.lights.push_back({.type = LightType::Directional, .direction = sunDirection, .intensity = sun});
    const LightSet lamp = emitterAt({0.5f, 1, -1}, {0, -1, 0}, vec3(6), 0.04f);
    const EmitterPatch sample = emitterPatches(lamp, 1).at(0);
    Settings settings;
    settings.shadow = shadow;
    settings.gather.glossy = true;
    settings.effects[EffectId::Emissive] = EffectMode::On;
    FrameResults results;
    results.surfaces = surfaces(floor.scene);
    const World world = placed->world(lamp);
    DirectLight direct(passes);
    Patches none;
    results.direct =
        lightOf(direct, world, results.surfaces, none, settings, stats);
    const Image image = readBuffer(Buffer::Direct, results);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Receiver receiver = floor.receiverAt(x, y);
        const vec3 at = floor.at(x, y);
        const auto reflected = [&](const vec3& irradiance, const vec3& towardsLight, float spread = 0) {
          return irradiance * (receiver.diffuse / kPi + glossyReflectance(receiver, towardsLight, spread));
        };
        const vec3 d = position - at, e = sample.position - at;
        const float r2 = glm::dot(d, d), q2 = glm::dot(e, e);
        const vec3 wanted = reflected(intensity * (d.y / std::pow(r2, 1.5f)), glm::normalize(d)) +
                            reflected(sun * -sunDirection.y, -sunDirection) +
                            reflected(vec3(6 * 0.04f * e.y * e.y / q2 / (q2 + 0.04f / kPi)), glm::normalize(e),
                                      lobeSpread(GatherSettings{}.spread, 0.04f, e.y / std::sqrt(q2), q2));
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(image.at(x, y)[c], wanted[c], 3e-3f * wanted[c] + 1e-5f) << x << ' ' << y << ' ' << f.roughness;
      }
  }
}

TEST_F(GlossyTest, FinishTextureReachesTheGBuffer) {
  GlossyFloor floor(vec3(0.5f), 0.8f, 0.5f);
  TextureImage image;
  image.width = image.height = 1;
  image.srgb = false;
  image.texels = {{255, 191, 102, 255}};
  floor.scene.assets.images.push_back(image);
  floor.scene.assets.materials[0].roughnessMetalnessTexture.image = 0;
  const GBuffer gbuffer = surfaces(floor.scene);
  for (const vec4& t : readTexture(*gbuffer.roughnessMetalness)) {
    ASSERT_NEAR(t.x, 0.8f * 191 / 255, 1e-4f);
    ASSERT_NEAR(t.y, 0.5f * 102 / 255, 1e-4f);
  }
  EXPECT_EQ(surfaces(floor.scene, false).roughnessMetalness, nullptr);
}

TEST_F(GlossyTest, FullGatherAgreesWithTheReference) {
  // One bounce in an empty box, where every light sees every point.
  const vec3 size(2, 1, 3), albedo(0.6f, 0.5f, 0.4f);
  for (const Finish& f : {Finish{albedo, 0.35f, 1}, Finish{albedo, 0.5f, 0}}) {
    HandScene scene;
    const uint32_t m = scene.material(albedo);
    scene.assets.materials[m].roughness = f.roughness;
    scene.assets.materials[m].metalness = f.metalness;
    scene.box(vec3(0), size, m, true);
    LightView point;
    point.position = {1.6f, 0.4f, 2.5f};
    scene.lights.push_back(point);
    scene.camera = cameraAt({1, 0.5f, 0.1f}, {1, 0.4f, 3}, 1, 24, 16);
    const SceneView view = scene.view();
    EmbreeQuery rays(scene.assets);
    rays.update(view);
    const LightSet lights = collectLights(view);
    RayCounts counts;
    const GBuffer gbuffer = surfaces(scene);
    const GatherSettings settings{.mode = GatherMode::Full, .disk = 0, .clamp = 3, .spread = 0};
    Settings all;
    all.gather = settings;
    std::vector<double> means;
    for (uint32_t set = 0; set < 32; ++set) {
      std::vector<Vpl> vpls = spreadOverBox(size, albedo, 2000, set);
      std::vector<VirtualLight> shown;
      for (Vpl& v : vpls) {
        v.radiance = albedo / kPi * punctualIrradiance(point, v.position, v.normal).irradiance;
        shown.push_back(lightOf(v));
      }
      const SurfaceLighting raw = gathered(gbuffer, shown, all);
      means.push_back(meanLuminance(indirectRadiance(gbuffer, filterPass.run({gbuffer, raw, {}}))));
    }
    const ReferenceInputs in{rays, lights, view.camera, 1, settings.clamp, 1, &view};
    ReferenceSums sums(24, 16);
    addSamples(sums, in, 2000, counts);
    const ReferencePicture picture = readReference(sums, in, ReferenceBuffer::Indirect);
    const double truth = meanLuminance(picture.mean);
    const Mean mean = meanOf(means);
    // 5e-4: the G-buffer's normals and albedos are half floats.
    EXPECT_LT(std::abs(mean.mean - truth),
              kDeviateLimit * std::hypot(mean.error, truth * picture.relativeErrorOfMean) + 5e-4 * truth)
        << mean.mean << " against " << truth << ", roughness " << f.roughness;
    EXPECT_LT(std::hypot(mean.error, truth * picture.relativeErrorOfMean), 0.015 * truth) << "too noisy to tell";
  }
}

/// A lit room with a metal block, by frames.
class GlossyFrameTest : public GlossyTest {
 protected:
  GlossyFrameTest() {
    for (const auto& [m, roughness, metalness] : {std::tuple(0, 0.4f, 0.0f), std::tuple(2, 0.5f, 0.7f)}) {
      room.scene.assets.materials[m].roughness = roughness;
      room.scene.assets.materials[m].metalness = metalness;
    }
    LightView light;
    light.position = {0.5f, 0.6f, 0.4f};
    light.intensity = vec3(1);
    room.scene.lights.push_back(light);
    settings.smc.vpls = 256;
    settings.smc.points = 256;
    settings.smc.warmup = 10;
    settings.shadow.resolution = 64;
    settings.shadow.maker = ShadowMaker::Rays;
    settings.debug.timing = TimingMode::Finish;
    settings.gather.glossy = true;
    settings.gather.mode = GatherMode::Full;
  }
  Room room;
  Settings settings;
};

TEST_F(GlossyFrameTest, MapsAgreeWithARayForEveryPair) {
  const auto radianceOf = [&](VplVisibility visibility) {
    settings.vpl.visibility = visibility;
    Viewer gi(settings);
    gi.run(room.scene.view());
    return gi.read(Buffer::Indirect);
  };
  expectClose("glossy-maps", radianceOf(VplVisibility::Maps), radianceOf(VplVisibility::Rays), 0.03);
}

TEST_F(GlossyFrameTest, BuffersAddUpAndSwitchingOffGoesBack) {
  settings.gather.mode = GatherMode::Interleaved;
  settings.smc.moves = 0;
  settings.history.frames = 0;
  Viewer gi(settings);
  gi.run(room.scene.view());
  const Image beauty = gi.read(Buffer::Beauty), direct = gi.read(Buffer::Direct), indirect = gi.read(Buffer::Indirect);
  for (size_t i = 0; i < beauty.pixels.size(); ++i)
    ASSERT_LT(glm::length(beauty.pixels[i] - direct.pixels[i] - indirect.pixels[i]),
              1e-3f * glm::length(beauty.pixels[i]) + 1e-6f);
  const Image irradiance = gi.read(Buffer::Irradiance);
  gi.settings().gather.glossy = false;
  SceneView still = room.scene.view();
  still.changes = {false, false, false, false, false};
  gi.run(still);
  EXPECT_EQ(relativeRmse(gi.read(Buffer::Irradiance), irradiance), 0) << "irradiance is that of Lambert surfaces";
  EXPECT_GT(relativeRmse(gi.read(Buffer::Beauty), beauty), 0.02);
}

} // namespace lambent::test
