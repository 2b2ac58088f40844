// The truth of blended surfaces: each sample draws which of those behind one another a pixel shows.
#include "gi/reference/live_reference.h"
#include "gi/reference/state_file.h"
#include "gi/reference/traced_image.h"
#include "tests/support/images.h"
#include "tests/support/reference.h"

namespace lambent::test::blended_test {

uint32_t pane(HandScene& scene, float alpha, const vec3& albedo, const vec3& emission = vec3(0)) {
  const uint32_t index = scene.glossyMaterial(albedo, 0.4f, 0);
  scene.assets.materials[index].emission = emission;
  scene.assets.materials[index].alphaMode = AlphaMode::Blend;
  scene.assets.materials[index].alpha = alpha;
  return index;
}

ReferenceImage traced(const HandScene& scene, uint32_t samples, ReferenceBuffer buffer, bool glossy = false,
                      int bounces = 0) {
  const TracedScene s(scene);
  return trace({.rays = s.rays,
                .lights = s.lights,
                .camera = scene.camera,
                .bounces = bounces,
                .glossy = glossy ? &s.view : nullptr,
                .blended = &s.view,
                .mixes = mixesBlended(s.view, buffer)},
               samples, buffer);
}

/// A pane of 0.3 before one of 0.5 before a wall, which all glow; beside the wall nothing is behind them.
TEST(BlendedReference, PixelsAreWithinTheirErrorsOfWhatIsSeen) {
  HandScene scene;
  scene.quad({-4, -4, 0}, {4, 0, 0}, {0, 8, 0}, scene.material(vec3(0), {1, 0, 0}));
  scene.quad({-4, -4, 1}, {8, 0, 0}, {0, 8, 0}, pane(scene, 0.5f, vec3(0), {0, 2, 0}));
  scene.quad({-4, -4, 2}, {8, 0, 0}, {0, 8, 0}, pane(scene, 0.3f, vec3(0), {0, 0, 3}));
  scene.sky = Sky({4, 4, 4});
  scene.camera = cameraAt({0, 0.01f, 4}, {0, 0.01f, 0}, 0.8f, 32, 24); // no pixel on a diagonal
  for (const ReferenceBuffer buffer : {ReferenceBuffer::Beauty, ReferenceBuffer::Direct}) {
    const ReferenceImage image = traced(scene, 256, buffer);
    double squares = 0, total = 0;
    int far = 0;
    for (const auto [x, y] : Pixels(image.mean)) {
      const vec3 behind = x < 16 ? vec3(1, 0, 0) : vec3(4);
      const vec3 wanted = 0.7f * (0.5f * behind + vec3(0, 1, 0)) + vec3(0, 0, 0.9f), off = image.mean.at(x, y) - wanted;
      for (int c = 0; c < 3; ++c) {
        far += std::abs(off[c]) > 3 * image.error.at(x, y)[c];
        squares += double(off[c] * off[c]);
        total += double(wanted[c]);
      }
      EXPECT_TRUE(image.surface[size_t(32 * y + x)]);
    }
    const double channels = 3 * 32 * 24;
    EXPECT_LE(far, 0.01 * channels);
    EXPECT_NEAR(std::sqrt(squares / channels) / (total / channels) / image.relativeError, 1, 0.1) << "errors as told";
  }
}

/// A floor under a decal that does not shade it shows so much of the one, and the rest of the other.
TEST(BlendedReference, ReflectedLightIsMixedByAlpha) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  constexpr float kAlpha = 0.6f;
  const auto floorOf = [&](std::optional<float> alpha, const vec3& albedo, ReferenceBuffer buffer, bool glossy) {
    HandScene scene;
    scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, scene.glossyMaterial(albedo, 0.4f, 0));
    if (alpha) scene.quad({-4, 1e-4f, -4}, {0, 0, 8}, {8, 0, 0}, pane(scene, *alpha, {0.8f, 0.2f, 0.5f}));
    scene.quad({-4, 0, -4}, {8, 0, 0}, {0, 4, 0}, scene.material(vec3(0.7f))); // lit, and not seen
    scene.lamp({0, 2, -1}, vec3(20));
    scene.camera = cameraAt({0, 2, 0.5f}, vec3(0), 0.6f, 24, 16);
    return traced(scene, 1024, buffer, glossy, 1);
  };
  for (const bool glossy : {false, true})
    for (const ReferenceBuffer buffer : {ReferenceBuffer::Beauty, ReferenceBuffer::Direct, ReferenceBuffer::Indirect}) {
      const ReferenceImage decal = floorOf({}, {0.8f, 0.2f, 0.5f}, buffer, glossy);
      const ReferenceImage below = floorOf({}, {0.1f, 0.6f, 0.3f}, buffer, glossy);
      const ReferenceImage both = floorOf(kAlpha, {0.1f, 0.6f, 0.3f}, buffer, glossy);
      const auto mean = [](const ReferenceImage& image) { return meanOf(image.mean).mean; };
      EXPECT_GT(std::abs(mean(decal) - mean(below)), 0.1 * mean(below));
      EXPECT_NEAR(mean(both) / glm::mix(mean(below), mean(decal), double(kAlpha)), 1, 0.01) << glossy << int(buffer);
      double squares = 0; // of differences, over their variance
      for (const auto [x, y] : Pixels(both.mean)) {
        const auto at = [&](const Image& of) { return of.at(x, y).x; };
        const float wanted = glm::mix(at(below.mean), at(decal.mean), kAlpha);
        const vec3 errors(at(both.error), kAlpha * at(decal.error), (1 - kAlpha) * at(below.error));
        squares += std::pow(double(at(both.mean) - wanted), 2) / double(glm::dot(errors, errors));
      }
      EXPECT_LT(squares / double(both.mean.pixels.size()), 2) << "each pixel shows both: " << glossy << int(buffer);
    }
}

TEST(BlendedReference, IrradianceIsOfOneSurface) {
  HandScene scene;
  scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0.5f)));
  scene.quad({-4, -4, 1}, {8, 0, 0}, {0, 8, 0}, pane(scene, 0.5f, vec3(0.5f)));
  scene.lamp({0, 0, 3});
  scene.camera = cameraAt({0, 0, 4}, vec3(0), 0.8f, 8, 8);
  const SceneView view = scene.view();
  EXPECT_EQ(traceImage(view, {}, {.buffer = ReferenceBuffer::Irradiance, .samples = 2}).samples, 2u);
  const TracedScene s(scene);
  ReferenceInputs in{.rays = s.rays, .lights = s.lights, .camera = scene.camera, .blended = &s.view};
  const uint64_t ofOne = referenceKey(view, in);
  in.mixes = true;
  EXPECT_NE(referenceKey(view, in), ofOne) << "sums of other meaning are not added to";
  SceneView hosts = view; // which draws blended surfaces itself
  hosts.camera.throughBlended = true;
  EXPECT_TRUE(mixesBlended(view, ReferenceBuffer::Beauty));
  EXPECT_FALSE(mixesBlended(hosts, ReferenceBuffer::Beauty));
}

TEST(BlendedReference, IsTheSameBesideAWindow) {
  HandScene scene;
  scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0.5f), vec3(1)));
  scene.quad({-4, -4, 1}, {8, 0, 0}, {0, 8, 0}, pane(scene, 0.5f, vec3(0.5f)));
  scene.lamp({0, 0, 3});
  scene.camera = cameraAt({0, 0, 4}, vec3(0), 0.8f, 8, 8);
  const Settings settings;
  LiveReference live(5);
  for (const ReferenceBuffer buffer : {ReferenceBuffer::Beauty, ReferenceBuffer::Irradiance, ReferenceBuffer::Direct}) {
    EXPECT_NE(live.follow(scene.view(kStill), settings, buffer), "") << "sums of other meaning";
    EXPECT_EQ(live.follow(scene.view(kStill), settings, buffer), "");
    const std::shared_ptr<const LiveTruth> truth = live.take(true);
    ASSERT_TRUE(truth);
    const TracedImage once =
        traceImage(scene.view(), settings, {.buffer = buffer, .samples = truth->samples, .seed = 5});
    EXPECT_TRUE(sameBits(truth->image.mean, once.image.mean)) << int(buffer);
  }
}

} // namespace lambent::test::blended_test
