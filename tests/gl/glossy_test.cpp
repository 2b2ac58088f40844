// Glossy receivers on the GPU against the shared BRDF evaluated on the CPU, pixel by pixel.
#include "frames.h"
#include "gi/direct/light_shadows.h"
#include "shaders/shared/ggx.h"
#include "tests/support/reference.h"
#include "tests/support/spread_lights.h"

namespace lambent::test::glossy_test {

class GlossyTest : public GatherTest {
 protected:
  /// The floor of one material, seen askew so that views, lights and lobes differ from pixel to pixel.
  struct GlossyFloor : Floor {
    GlossyFloor(const vec3& albedo, float roughness, float metalness, bool orthographic = false)
        : Floor(albedo, roughness, metalness) {
      scene.camera = cameraAt(vec3(1, 2, 2.2f), vec3(0), 0.7f);
      if (orthographic) scene.camera.orthoHalfHeight = 1.2f;
    }
    Receiver receiverAt(int x, int y) const {
      const Material& m = scene.assets.materials[0];
      const vec3 towardsViewer = scene.camera.orthoHalfHeight > 0 ? vec3(scene.camera.worldFromView[2])
                                                                  : glm::normalize(scene.camera.position() - at(x, y));
      return makeReceiver({0, 1, 0}, towardsViewer, m.baseColor, plainFinish(m.roughness, m.metalness));
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
    const gl::Texture& picture = compositePass.run({gbuffer, {}, indirect, vec3(0)});
    FrameResults results;
    results.surfaces = gbuffer;
    results.radiance = &picture;
    const Image beauty = readBuffer(Buffer::Beauty, results);
    for (const auto [x, y] : Pixels(image)) {
      const vec3 d = position - floor.at(x, y), towardsLight = glm::normalize(d);
      const float r2 = glm::dot(d, d);
      const vec3 irradiance =
          radiance * (kArea * std::max(0.0f, -glm::dot(normal, towardsLight)) * towardsLight.y / (r2 + kArea / kPi));
      const Receiver receiver = floor.receiverAt(x, y);
      const vec3 lambert = irradiance * receiver.diffuse / kPi;
      const float spread = lobeSpread(GatherSettings{}.spread, kArea, -glm::dot(normal, towardsLight), r2);
      const vec3 lobe = irradiance * glossyReflectance(forVirtualLights(receiver, 0), towardsLight, spread);
      for (int c = 0; c < 3; ++c) {
        const float wanted = lambert[c] + lobe[c];
        ASSERT_NEAR(image.at(x, y)[c], wanted, byHalfFloats(3e-3f, 3e-2f) * wanted + 1e-6f)
            << x << ' ' << y << " roughness " << f.roughness;
        ASSERT_NEAR(beauty.at(x, y)[c], wanted, byHalfFloats(3e-3f, 3e-2f) * wanted + 1e-6f) << x << ' ' << y;
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
  for (int i = 0; i < 2; ++i)
    scene.quad({i ? 0.0f : -9.0f, -9, 0}, {9, 0, 0}, {0, 18, 0}, scene.glossyMaterial(colors[i], 0.5f, 1));
  scene.camera = cameraAt({0, 0, 3}, vec3(0), 1);
  const GBuffer gbuffer = surfaces(scene);
  const gl::Texture black = textureOf(Image(64, 48)), constant = textureOf(Image(64, 48, vec3(2, 3, 4)));
  for (const bool on : {true, false})
    for (const FilterKernel kernel : {FilterKernel::Separable, FilterKernel::Whole}) {
      const SurfaceLighting raw{&black, &constant, true};
      const Image image = indirectRadiance(gbuffer, filterPass.run({gbuffer, raw, {.on = on, .kernel = kernel}}));
      for (const auto [x, y] : Pixels(64, 48)) {
        const vec3 towardsViewer = -pixelRay(scene.camera, x, y).direction;
        const vec3 tint = glossyTint(makeReceiver({0, 0, 1}, towardsViewer, colors[x >= 32], plainFinish(0.5f, 1)));
        ASSERT_LT(glm::length(image.at(x, y) - tint * vec3(2, 3, 4)), 4e-3f) << x << ' ' << y;
        ASSERT_LT(glm::length(tint - colors[x >= 32]), 0.15f) << "what meets several facets adds little to it";
      }
    }
}

TEST_F(GlossyTest, PunctualLightsAndEmissiveSamples) {
  const vec3 position(-0.6f, 0.9f, -1.2f), intensity(5, 4, 3);
  const vec3 sunDirection = glm::normalize(vec3(-0.3f, -0.7f, -0.8f)), sun(2, 2, 1);
  const ShadowSettings shadow{.sunResolution = 512, .pointResolution = 512, .spotResolution = 512};
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
    const Image image = directOf(passes, floor.scene, lamp, settings, stats);
    const vec3 reflects = floor.scene.assets.materials[0].glossy() ? vec3(1) : f.albedo / kPi; // else it is irradiance
    for (const auto [x, y] : Pixels(image)) {
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
        ASSERT_NEAR(image.at(x, y)[c] * reflects[c], wanted[c], byHalfFloats(3e-3f, 3e-2f) * wanted[c] + 1e-5f)
            << x << ' ' << y << ' ' << f.roughness;
    }
  }
}

TEST_F(GlossyTest, FinishTextureReachesTheGBuffer) {
  GlossyFloor floor(vec3(0.5f), 0.8f, 0.5f);
  floor.scene.assets.materials[0].roughnessMetalnessTexture = floor.scene.texture(1, {{255, 191, 102, 255}}, false);
  const GBuffer gbuffer = surfaces(floor.scene);
  for (const vec4& t : readTexture(*gbuffer.finish)) {
    ASSERT_NEAR(t.x, 0.8f * 191 / 255, 1e-4f);
    ASSERT_NEAR(t.y, 0.5f * 102 / 255, 1e-4f);
    ASSERT_EQ(vec2(t.z, t.w), vec2(0, 1));
  }
  floor.scene.assets.materials[0].dielectricF0 = 0.1f;
  floor.scene.assets.materials[0].dielectricLobe = 0.25f;
  for (const vec4& t : readTexture(*surfaces(floor.scene).finish))
    ASSERT_LT(glm::length(vec2(t.z, t.w) - vec2(0.1f, 0.25f)), 1e-4f);
  EXPECT_EQ(surfaces(floor.scene, false).finish, nullptr);
}

TEST_F(GlossyTest, FullGatherAgreesWithTheReference) {
  // One bounce in an empty box, where every light sees every point.
  for (const Finish& f : {Finish{{}, 0.35f, 1}, Finish{{}, 0.5f, 0}}) {
    ReferenceBox box(f.roughness, f.metalness);
    HandScene& scene = box.scene;
    scene.camera = cameraAt({1, 0.5f, 0.1f}, {1, 0.4f, 3}, 1, 24, 16);
    const TracedScene traced(scene);
    const GBuffer gbuffer = surfaces(scene);
    const GatherSettings settings{.mode = GatherMode::Full, .disk = 0, .clamp = 3, .spread = 0, .mirrors = 0};
    Settings all;
    all.gather = settings;
    std::vector<double> means;
    for (uint32_t set = 0; set < 32; ++set) {
      std::vector<Vpl> vpls = spreadOverBox(box.size, box.albedo, 2000, set);
      std::vector<VirtualLight> shown;
      for (Vpl& v : vpls) {
        v.radiance = box.albedo / kPi * punctualIrradiance(scene.lights[0], v.position, v.normal).irradiance;
        shown.push_back(lightOf(v));
      }
      const SurfaceLighting raw = gathered(gbuffer, shown, all);
      means.push_back(meanLuminance(indirectRadiance(gbuffer, filterPass.run({gbuffer, raw, {}}))));
    }
    const ReferenceInputs in{traced.rays, traced.lights, scene.camera, 1, settings.clamp, 1, &traced.view};
    const ReferenceImage picture = trace(in, 2000, ReferenceBuffer::Indirect);
    const Mean truth{meanLuminance(picture.mean), meanLuminance(picture.mean) * picture.relativeErrorOfMean};
    // 5e-4: the G-buffer's normals and albedos are half floats.
    EXPECT_TRUE(agrees(meanOf(means), truth, 0.01 * truth.mean, 5e-4 * truth.mean)) << "roughness " << f.roughness;
    EXPECT_LT(truth.error, 0.01 * truth.mean) << "too noisy to tell";
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
    room.scene.lamp({0.5f, 0.6f, 0.4f}, vec3(1));
    settings.smc = {.vpls = 256, .points = 256, .warmup = 10};
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
    return firstFrame(settings, room.scene.view(), Buffer::Indirect);
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
  EXPECT_EQ(relativeRmse(nextFrame(gi, room.scene.view(kStill)), irradiance), 0)
      << "irradiance is that of Lambert surfaces";
  EXPECT_GT(relativeRmse(gi.read(Buffer::Beauty), beauty), 0.02);
}

} // namespace lambent::test::glossy_test
