// Direct light of what has a size: the sampler against closed forms and path tracing, and means over frames.
#include "frames.h"
#include "gi/direct/soft_sampler.h"
#include "gi/lighting/receivers.h"
#include "tests/support/area_pieces.h"
#include "tests/support/daylight.h"
#include "tests/support/reference.h"

namespace lambent::test::soft_light_test {

/// What the scene's camera sees, on the CPU.
struct Seen {
  TracedScene traced;
  std::vector<float> depth;
  std::vector<vec4> normal;
  FrameSurfaces surfaces;

  explicit Seen(const HandScene& scene) : traced(scene) {
    const CameraView& camera = scene.camera;
    for (int y = camera.height - 1; y >= 0; --y)
      for (int x = 0; x < camera.width; ++x) {
        const CameraRay ray = pixelRay(camera, x, y);
        const SurfaceHit hit = traced.rays.closest(Ray{ray.origin, ray.direction});
        const float along = -glm::dot(hit.position - ray.origin, vec3(camera.worldFromView[2]));
        depth.push_back(hit.valid() ? camera.near / along : 0);
        normal.emplace_back(hit.normal, 1);
      }
    surfaces = {camera.width, camera.height, depth, normal, cameraBlock(camera, 1000)};
  }

  /// Irradiance, or lobes' light; row 0 at the top.
  Image sampled(int samples, uint32_t first = 0, bool glossy = false, uint32_t seed = 1, const MoreSamples& more = {},
                bool byImage = true) const {
    RayCounts counts;
    const LightSet lights = softLightsOf(traced.lights, SoftParts::All);
    const SoftLight light = sampleSoftLight({.rays = traced.rays,
                                             .lights = lights,
                                             .view = traced.view,
                                             .surfaces = byImage ? &surfaces : nullptr,
                                             .samples = samples,
                                             .more = more,
                                             .sample = first,
                                             .glossy = glossy,
                                             .seed = seed},
                                            counts);
    Image image(surfaces.width, surfaces.height);
    image.pixels = glossy ? light.glossy : light.irradiance;
    return image;
  }
};

/// A floor under a lamp close by, half of which a screen hides from a part of the floor.
struct LampOverFloor : Floor {
  AreaPiece lamp = quadPiece({-0.6f, 0.5f, -0.4f}, {1.2f, 0, 0}, {0, 0, 0.8f});

  LampOverFloor() {
    scene.quad({-0.6f, 0.5f, -0.4f}, {1.2f, 0, 0}, {0, 0, 0.8f}, scene.material(vec3(0), vec3(3, 2, 1)));
    scene.camera = cameraAt(vec3(0, 0.45f, 0), vec3(0), 1.8f, 32, 32);
  }
};

TEST(SoftSampler, ALampBringsWhatItsFormFactorSays) {
  LampOverFloor floor;
  const Image light = Seen(floor.scene).sampled(1024);
  double squares = 0;
  for (const auto [x, y] : Pixels(light)) {
    const double wanted = double(areaFormFactor(floor.lamp, floor.at(x, y), vec3(0, 1, 0)));
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(double(light.at(x, y)[c]), wanted * (3 - c), 0.05 * wanted * (3 - c)) << x << ' ' << y;
    squares += std::pow(double(light.at(x, y).x) / wanted / 3 - 1, 2);
  }
  const double rmse = std::sqrt(squares / double(light.pixels.size()));
  std::printf("relative error of 1024 samples: %.4f\n", rmse);
  EXPECT_LT(rmse, 0.01);
}

TEST(SoftSampler, TriangleAndPlaceOnItAreIndependent) { // or a shadow falls on a part of each alone
  LampOverFloor floor;
  floor.scene.quad({0.1f, 0.2f, -2}, {2, 0, 0}, {0, 0, 4}, floor.scene.material(vec3(0)));
  const Seen seen(floor.scene);
  const Image light = seen.sampled(1024), truth = trace({seen.traced.rays, seen.traced.lights, floor.scene.camera, 0},
                                                        4096, ReferenceBuffer::Direct)
                                                      .mean; // over albedo/π
  double squares = 0, mean = 0, n = 0;
  for (const auto [x, y] : Pixels(light)) {
    const CameraRay ray = pixelRay(floor.scene.camera, x, y);
    if (seen.traced.rays.closest(Ray{ray.origin, ray.direction}).position.y > 0.1f)
      continue; // the screen, which is black
    const double wanted = double(truth.at(x, y).x) * double(kPi) / 0.5;
    squares += std::pow(double(light.at(x, y).x) - wanted, 2), mean += wanted, ++n;
  }
  std::printf("%g pixels, error %.4f of the mean\n", n, std::sqrt(squares / n) / (mean / n));
  EXPECT_GT(n, 300);
  EXPECT_LT(std::sqrt(squares / n) / (mean / n), 0.03);
}

TEST(SoftSampler, SamplesOfAPixelAndOfABlockAreSpread) {
  LampOverFloor floor;
  const Seen seen(floor.scene);
  const auto rmse = [&](int samples, uint32_t first) {
    const Image light = seen.sampled(samples, first);
    double squares = 0;
    for (const auto [x, y] : Pixels(light))
      squares +=
          std::pow(double(light.at(x, y).x) / 3 / double(areaFormFactor(floor.lamp, floor.at(x, y), {0, 1, 0})) - 1, 2);
    return std::sqrt(squares / double(light.pixels.size()));
  };
  const double one = rmse(1, 0), many = rmse(64, 0), late = rmse(64, 64 * 5);
  std::printf("relative error of 1 and of 64 samples: %.3f, %.4f (later ones: %.4f)\n", one, many, late);
  EXPECT_LT(many, 0.6 * one / 8) << "of random ones an eighth";
  EXPECT_LT(late, 0.6 * one / 8);
  // One sample at each pixel of 4×4: their mean against that of the closed forms.
  const Image light = seen.sampled(1);
  double ofBlocks = 0;
  for (int by = 0; by < 32; by += 4)
    for (int bx = 0; bx < 32; bx += 4) {
      double got = 0, wanted = 0;
      for (int i = 0; i < 16; ++i) {
        got += double(light.at(bx + i % 4, by + i / 4).x) / 3;
        wanted += double(areaFormFactor(floor.lamp, floor.at(bx + i % 4, by + i / 4), {0, 1, 0}));
      }
      ofBlocks += std::pow(got / wanted - 1, 2) / 64;
    }
  std::printf("of blocks of one sample each: %.4f\n", std::sqrt(ofBlocks));
  EXPECT_LT(std::sqrt(ofBlocks), 0.7 * one / 4) << "of random ones a quarter";
}

TEST(SoftSampler, PixelsMayHaveMoreSamples) {
  LampOverFloor floor;
  std::vector<uint8_t> more(32 * 32, 0);
  const auto asked = [](int x, int y) { return x >= 16 && y < 8; };
  for (const auto [x, y] : Pixels(32, 32))
    if (asked(x, y)) more[size_t(31 - y) * 32 + size_t(x)] = 30;
  Seen seen(floor.scene);
  const Image light = seen.sampled(2, 0, false, 1, {more, 32, 32, cameraBlock(floor.scene.camera, 1000).clipFromWorld});
  constexpr double kPixels[2] = {896, 128};
  double squares[2] = {0, 0}, sum[2] = {0, 0};
  for (const auto [x, y] : Pixels(light)) {
    const double error =
        double(light.at(x, y).x) / 3 / double(areaFormFactor(floor.lamp, floor.at(x, y), vec3(0, 1, 0))) - 1;
    const int i = asked(x, y);
    squares[i] += error * error / kPixels[i], sum[i] += error / kPixels[i];
  }
  std::printf("relative error of 2 and of 32 samples: %.4f, %.4f\n", std::sqrt(squares[0]), std::sqrt(squares[1]));
  EXPECT_LT(std::sqrt(squares[1]), 0.3 * std::sqrt(squares[0]));
  for (int i = 0; i < 2; ++i) EXPECT_LT(std::abs(sum[i]), 4 * std::sqrt(squares[i] / kPixels[i])) << i;
}

TEST(SoftSampler, RaysAloneFindThePlacesThatTheImageShows) {
  LampOverFloor floor;
  floor.scene.quad({-0.9f, 0, -0.9f}, {0.5f, 0.3f, 0}, {0, 0, 0.5f}, floor.scene.material(vec3(0.5f)));
  const Seen seen(floor.scene);
  const Image byImage = seen.sampled(4), byRays = seen.sampled(4, 0, false, 1, {}, false);
  for (const auto [x, y] : Pixels(byImage))
    ASSERT_LT(maxComponent(glm::abs(byImage.at(x, y) - byRays.at(x, y))),
              1e-4f * maxComponent(byImage.at(x, y)) + 1e-5f)
        << x << ' ' << y;
}

TEST(SoftSampler, OpenPlatesGetTheWholeSky) {
  for (const bool day : {false, true})
    for (const vec3& n : {vec3(0, 1, 0), vec3(0, -1, 0), directionAt(30, 150), directionAt(10, 300)}) {
      HandScene scene;
      vec3 s, t;
      basisAround(n, s, t);
      scene.quad(-2.0f * (s + t), 4.0f * s, 4.0f * t, scene.material(vec3(0.5f)));
      scene.camera = cameraAt(3.0f * n + 0.2f * s, vec3(0), 0.5f, 32, 32);
      scene.sky = day ? Sky::daylight(directionAt(20, 65), 3) : Sky(vec3(1, 2, 3));
      const Image light = Seen(scene).sampled(256);
      const dvec3 wanted = openIrradiance(scene.sky, n, 512);
      for (int c = 0; c < 3; ++c) {
        vec3 channel(0);
        channel[c] = 1;
        EXPECT_NEAR(meanOf(light, channel).mean, wanted[c], 2e-3 * wanted[c]) << day << ' ' << n.y << ' ' << c;
      }
      if (day) continue;
      for (const vec3& p : light.pixels) ASSERT_NEAR(p.y, 2 * kPi, 1e-4f);
    }
}

/// Share of a disk of radius 1 that lies beyond a line at distance x from its middle.
double shareBeyond(double x) {
  if (x <= -1) return 1;
  if (x >= 1) return 0;
  return (std::acos(x) - x * std::sqrt(1 - x * x)) / std::acos(-1.0);
}

TEST(SoftSampler, SunsHaveThePenumbraeOfTheirDisks) {
  // A half plane at a height of 1 m; the sun stands overhead, so that the penumbra is as wide as the disk.
  Floor floor;
  const float radius = 0.1f;
  floor.scene.lights.push_back(
      {.type = LightType::Directional, .direction = {0, -1, 0}, .intensity = vec3(2), .angularRadius = radius});
  floor.scene.quad({-5, 1, -5}, {0, 0, 10}, {5, 0, 0}, floor.scene.material(vec3(0)));
  floor.scene.camera = cameraAt(vec3(0, 0.9f, 0), vec3(0), 0.5f, 32, 32);
  const Image light = Seen(floor.scene).sampled(1024);
  int between = 0;
  for (const auto [x, y] : Pixels(light)) {
    const double at = double(floor.at(x, y).x) / std::tan(double(radius)), wanted = 2 * shareBeyond(-at);
    ASSERT_NEAR(double(light.at(x, y).x), wanted, 0.02) << x << ' ' << y; // cosines on the disk: 0.3 %
    between += wanted > 0.2 && wanted < 1.8;
  }
  EXPECT_GT(between, 200);
}

TEST(SoftSampler, LobesAreLitAsTheReferenceHasThem) {
  Floor floor(vec3(0.4f), 0.35f, 0.5f);
  floor.scene.quad({-0.6f, 1.5f, -0.4f}, {1.2f, 0, 0}, {0, 0, 0.8f}, floor.scene.material(vec3(0), vec3(3)));
  floor.scene.sky = Sky(vec3(0.3f));
  floor.scene.camera = cameraAt(vec3(0, 0.8f, 2), vec3(0, 0, 0.3f), 0.4f, 32, 32);
  const Seen seen(floor.scene);
  const Image diffuse = seen.sampled(256), glossy = seen.sampled(256, 0, true);
  const Mean truth = meanOf(trace({.rays = seen.traced.rays,
                                   .lights = seen.traced.lights,
                                   .camera = floor.scene.camera,
                                   .bounces = 0,
                                   .glossy = &seen.traced.view},
                                  1024, ReferenceBuffer::Direct)
                                .mean);
  double sum = 0;
  for (const auto [x, y] : Pixels(diffuse)) {
    const CameraRay ray = pixelRay(floor.scene.camera, x, y);
    const Receiver r = receiverOf(seen.traced.view, seen.traced.rays.closest(Ray{ray.origin, ray.direction}));
    sum += double(luminance(diffuse.at(x, y) * r.diffuse / kPi + glossy.at(x, y) * glossyTint(r)));
  }
  EXPECT_NEAR(sum / double(diffuse.pixels.size()), truth.mean, 0.01 * truth.mean);
}

class SoftLightTest : public GlTest {
 protected:
  SoftLightTest() {
    settings.effects[EffectId::Indirect] = EffectMode::Off;
    settings.image.exposure = 1;
    room.scene.quad({-0.4f, 0.9f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, room.scene.material(vec3(0), vec3(4)));
  }
  /// Radiance by direct light after frames of a view that stands.
  Image stand(Viewer& gi, int frames) {
    gi.run(room.scene.view());
    for (int i = 1; i < frames; ++i) gi.run(room.scene.view(kStill));
    return gi.read(Buffer::Direct);
  }
  Image truthOf(const HandScene& scene, uint32_t samples = 1024) const {
    const TracedScene traced(scene);
    return trace({traced.rays, traced.lights, scene.camera, 0}, samples, ReferenceBuffer::Direct).mean;
  }

  Settings settings;
  Room room;
};

TEST_F(SoftLightTest, AStillViewConvergesAndRests) {
  const Image truth = truthOf(room.scene);
  Viewer gi(settings);
  const double first = relativeRmse(stand(gi, 1), truth);
  for (int i = 1; i < 64; ++i) {
    const FrameStats& stats = gi.run(room.scene.view(kStill));
    ASSERT_TRUE(stats.plan.on(EffectId::Redraw)) << i;
    ASSERT_TRUE(stats.plan.onlyDirect()) << i;
  }
  gi.run(room.scene.view(kStill));
  const Image last = gi.read(Buffer::Direct);
  std::printf("error of the first frame %.4f, of the last %.4f\n", first, relativeRmse(last, truth));
  EXPECT_LT(first, 0.05);
  EXPECT_LT(relativeRmse(last, truth), 0.006);
  EXPECT_NEAR(meanLuminance(last), meanLuminance(truth), 2e-3 * meanLuminance(truth));
  const FrameStats& asleep = gi.run(room.scene.view(kStill));
  EXPECT_FALSE(asleep.plan.on(EffectId::Redraw)) << asleep.plan[EffectId::Redraw].reason;
  EXPECT_EQ(asleep.raysSoft.closest, 0u);
  EXPECT_TRUE(sameBits(gi.read(Buffer::Direct), last));
}

TEST_F(SoftLightTest, SkyAndSunConverge) {
  HandScene scene;
  const uint32_t white = scene.material(vec3(0.7f));
  scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), white);
  scene.box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, white, false);
  scene.sky = Sky::daylight(directionAt(40, 60), 3);
  scene.lights.push_back({.type = LightType::Directional,
                          .direction = -directionAt(40, 60),
                          .intensity = daylightSun(directionAt(40, 60), 3),
                          .angularRadius = 0.02f});
  scene.camera = cameraAt({2, 2, 3}, {0, 0.4f, 0}, 0.8f);
  Viewer gi(settings);
  gi.run(scene.view());
  for (int i = 1; i < 64; ++i) gi.run(scene.view(kStill));
  EXPECT_EQ(gi.stats().lightMapsDrawn, 0u) << "neither has maps";
  const Image truth = truthOf(scene, 2048), light = gi.read(Buffer::Direct);
  EXPECT_LT(relativeRmse(light, truth), 0.02);
  EXPECT_NEAR(meanLuminance(light), meanLuminance(truth), 2e-3 * meanLuminance(truth));
}

TEST_F(SoftLightTest, MovingViewsHaveLessNoiseThanAFrameAlone) {
  for (const SceneChanges& changes : {kCameraChanged, kLightsChanged}) {
    const Image truth = truthOf(room.scene);
    const double alone = relativeRmse(firstFrame(settings, room.scene.view(), Buffer::Direct), truth);
    Viewer gi(settings);
    gi.run(room.scene.view());
    if (changes.camera) room.scene.camera.worldFromView[3].x += 0.16f;
    for (int i = 1; i <= 16; ++i) {
      if (changes.camera) room.scene.camera.worldFromView[3].x -= 0.01f;
      gi.run(room.scene.view(changes));
    }
    const double error = relativeRmse(gi.read(Buffer::Direct), truth);
    std::printf("error in motion %.4f, of one frame %.4f\n", error, alone);
    EXPECT_LT(error, 0.6 * alone);
  }
}

/// A floor with the sharp shadow of a board, by a small lamp, seen by a camera that walks along it.
struct ShadowOnFloor : Floor {
  explicit ShadowOnFloor(float lamp = 0.01f) : Floor(vec3(0.5f)) {
    scene.quad({-0.8f, 1, 0}, {lamp, 0, 0}, {0, 0, lamp}, scene.material(vec3(0), vec3(5 / (lamp * lamp))));
    scene.quad({-0.3f, 0, -1}, {0, 0, 2}, {0, 0.5f, 0}, scene.material(vec3(0))); // its shadow ends at x = 0.2
    at(0);
  }
  void at(float x) { scene.camera = cameraAt(vec3(x, 1.2f, 0), vec3(x, 0, -0.01f), 0.9f); }
  /// Light in the shadow, and RMS of the error within two pixels of its edges, over the light beside them.
  std::pair<double, double> after(Viewer& gi, float step, int frames) {
    at(-float(frames) * step);
    gi.run(scene.view());
    for (int i = frames - 1; i >= 0; --i) {
      at(-float(i) * step);
      gi.run(scene.view(kCameraChanged));
    }
    const TracedScene traced(scene);
    const Image truth = trace({traced.rays, traced.lights, scene.camera, 0}, 256, ReferenceBuffer::Direct).mean;
    const Image light = gi.read(Buffer::Direct);
    double lit = 0, dark = 0, squares = 0;
    int shadow = 0, edge = 0;
    for (const auto [x, y] : Pixels({2, 2}, {truth.width - 2, truth.height - 2})) {
      const double left = double(truth.at(x - 2, y).x), right = double(truth.at(x + 2, y).x);
      if (truth.at(x, y).x == 0) dark += double(light.at(x, y).x), ++shadow;
      if ((left > 0) == (right > 0)) continue;
      squares += std::pow(double(light.at(x, y).x - truth.at(x, y).x), 2);
      lit += left + right, ++edge;
    }
    EXPECT_GT(shadow, 500);
    EXPECT_GT(edge, 100);
    return {dark / shadow / (lit / edge), std::sqrt(squares / edge) / (lit / edge)};
  }
};

TEST_F(SoftLightTest, ShadowsStaySharpInMotion) {
  ShadowOnFloor floor;
  for (const float step : {0.005f, 0.02f}) { // 0.3 and 1.2 pixels
    Viewer gi(settings);
    const auto [leak, edge] = floor.after(gi, step, 24);
    std::printf("%g m a frame: in the shadow %.5f of the light, error along its edge %.4f\n", double(step), leak, edge);
    EXPECT_LT(leak, 5e-5) << "by the variance of all taps 1.2e-4, with means of all frames 7e-3";
    EXPECT_LT(edge, 0.01) << "with means of all frames 0.08";
  }
}

TEST_F(SoftLightTest, EdgesInMotionGetMoreSamples) {
  ShadowOnFloor floor(0.04f);
  double error[2];
  uint64_t rays[2], still[2];
  for (int i = 0; i < 2; ++i) {
    settings.direct.mostSamples = i == 0 ? settings.direct.samples : 16;
    settings.filter.on = false;
    Viewer gi(settings);
    error[i] = floor.after(gi, 0.0623f, 12).second; // four pixels: samples must go where the edge is now
    rays[i] = gi.stats().raysSoft.closest;
    still[i] = gi.run(floor.scene.view(kStill)).raysSoft.closest;
  }
  std::printf("error along edges %.4f with %llu rays, %.4f with %llu\n", error[0], (unsigned long long)rays[0],
              error[1], (unsigned long long)rays[1]);
  EXPECT_LT(error[1], 0.8 * error[0]);
  EXPECT_GT(rays[1], rays[0] + rays[0] / 100);
  EXPECT_LT(rays[1], rays[0] + rays[0] / 2) << "elsewhere means hold many frames";
  EXPECT_EQ(still[1], still[0]);
}

TEST_F(SoftLightTest, AViewThatComesToRestForgetsTheBlurOfItsMotion) {
  Viewer gi(settings);
  room.scene.camera.worldFromView[3].x += 0.2f;
  gi.run(room.scene.view());
  for (int i = 0; i < 20; ++i) {
    room.scene.camera.worldFromView[3].x -= 0.01f;
    gi.run(room.scene.view(kCameraChanged));
  }
  const Image truth = truthOf(room.scene);
  const double moving = relativeRmse(gi.read(Buffer::Direct), truth);
  int frames = 0;
  while (gi.run(room.scene.view(kStill)).plan.on(EffectId::Redraw)) ASSERT_LT(++frames, 400);
  const double still = relativeRmse(gi.read(Buffer::Direct), truth);
  std::printf("error after motion %.4f, after %d still frames %.4f\n", moving, frames, still);
  EXPECT_LT(still, 0.0035);
}

TEST_F(SoftLightTest, FramesByThemselvesRestAtOnce) {
  const Image first = firstFrame(settings, room.scene.view(), Buffer::Direct);
  settings.direct.frames = 0;
  Viewer gi(settings);
  EXPECT_TRUE(sameBits(stand(gi, 2), first));
  EXPECT_FALSE(gi.run(room.scene.view(kStill)).plan.on(EffectId::Redraw));
  const Image truth = truthOf(room.scene);
  const double error = relativeRmse(first, truth);
  for (int i = 0; i < 8; ++i) gi.run(room.scene.view(kLightsChanged));
  EXPECT_NEAR(relativeRmse(gi.read(Buffer::Direct), truth), error, 0.15 * error) << "nothing is averaged";
}

TEST_F(SoftLightTest, OtherWaysOfALampTakeItsLightAlong) {
  room.scene.sky = Sky(vec3(0.2f)); // goes on being sampled
  Viewer gi(settings);
  stand(gi, 64);
  for (const EmitterShadows by : {EmitterShadows::Patches, EmitterShadows::Samples}) {
    gi.settings().shadow.emitters = by;
    for (int i = 0; i < 32; ++i) gi.run(room.scene.view(kStill));
    const Image truth = truthOf(room.scene), light = gi.read(Buffer::Direct);
    EXPECT_NEAR(meanLuminance(light), meanLuminance(truth), 0.01 * meanLuminance(truth)) << int(by);
  }
}

TEST_F(SoftLightTest, LobesConvergeAndFollow) {
  Floor floor(vec3(0.4f), 0.35f, 0.5f);
  floor.scene.quad({-0.6f, 1.5f, -0.4f}, {1.2f, 0, 0}, {0, 0, 0.8f}, floor.scene.material(vec3(0), vec3(3)));
  floor.scene.camera = cameraAt(vec3(0, 0.8f, 2), vec3(0, 0, 0.3f), 0.4f);
  const TracedScene traced(floor.scene);
  const Image truth = trace({.rays = traced.rays,
                             .lights = traced.lights,
                             .camera = floor.scene.camera,
                             .bounces = 0,
                             .glossy = &traced.view},
                            512, ReferenceBuffer::Direct)
                          .mean;
  settings.gather.glossy = true;
  Viewer gi(settings);
  gi.run(floor.scene.view());
  for (int i = 1; i < 64; ++i) gi.run(floor.scene.view(kStill));
  EXPECT_NEAR(meanLuminance(gi.read(Buffer::Direct)), meanLuminance(truth), 0.01 * meanLuminance(truth));
  EXPECT_LT(relativeRmse(gi.read(Buffer::Direct), truth), 0.06);
  for (int i = 0; i < 12; ++i) gi.run(floor.scene.view(kLightsChanged));
  EXPECT_NEAR(meanLuminance(gi.read(Buffer::Direct)), meanLuminance(truth), 0.02 * meanLuminance(truth));
  EXPECT_LT(relativeRmse(gi.read(Buffer::Direct), truth), 0.1);
  for (int i = 15; i >= 0; --i) {
    floor.scene.camera = cameraAt(vec3(0.01f * float(i), 0.8f, 2), vec3(0.01f * float(i), 0, 0.3f), 0.4f);
    gi.run(floor.scene.view(kCameraChanged));
  }
  const Image moving = gi.read(Buffer::Direct);
  std::printf("in motion %.4f of the light, error %.4f\n", meanLuminance(moving) / meanLuminance(truth),
              relativeRmse(moving, truth));
  EXPECT_NEAR(meanLuminance(moving), meanLuminance(truth), 0.02 * meanLuminance(truth));
  EXPECT_LT(relativeRmse(moving, truth), 0.1);
}

TEST_F(SoftLightTest, LightThatFadesLeavesNoNoiseBehind) { // or the filter blurs edges of what is left
  Floor floor;
  floor.scene.quad({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, floor.scene.material(vec3(0)));
  floor.scene.sky = Sky(vec3(1));
  Viewer gi(settings);
  gi.run(floor.scene.view());
  for (int i = 1; i < 20; ++i) gi.run(floor.scene.view(kStill));
  floor.scene.sky = Sky(vec3(0.01f));
  for (int i = 0; i < 12; ++i) gi.run(floor.scene.view(kLightsChanged));
  const double error = relativeRmse(gi.read(Buffer::Direct), truthOf(floor.scene));
  std::printf("error after light faded: %.4f\n", error);
  EXPECT_LT(error, 0.014) << "with the variance of the light before 0.0165";
}

TEST_F(SoftLightTest, LightThatGoesIsGoneSoon) {
  Floor floor;
  floor.scene.box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, floor.scene.material(vec3(0.7f)), false);
  floor.scene.sky = Sky(vec3(1));
  Viewer gi(settings);
  gi.run(floor.scene.view());
  for (int i = 1; i < 20; ++i) gi.run(floor.scene.view(kStill));
  const double lit = meanLuminance(gi.read(Buffer::Direct));
  floor.scene.sky = Sky(vec3(0.01f));
  gi.run(floor.scene.view(kLightsChanged));
  EXPECT_LT(meanLuminance(gi.read(Buffer::Direct)), 0.1 * lit) << "tiles that change by so much begin again";
  for (int i = 0; i < 3; ++i) gi.run(floor.scene.view(kStill));
  EXPECT_LT(meanLuminance(gi.read(Buffer::Direct)), 0.02 * lit);
}

TEST_F(SoftLightTest, ClosedRoomsAreBlackUnderAnySky) {
  for (const float size : {1.0f, 1e3f})
    for (const bool day : {false, true}) {
      HandScene scene;
      scene.box(vec3(-size), vec3(size), scene.material(vec3(0.7f)), true);
      scene.camera = cameraAt(vec3(0.1f, 0.1f, 0.9f) * size, vec3(0, -0.2f, -1) * size, 1.6f);
      scene.sky = day ? Sky::daylight(directionAt(40, 60), 3) : Sky(vec3(1));
      Viewer gi(settings);
      gi.run(scene.view());
      for (int i = 0; i < 8; ++i) gi.run(scene.view(kStill));
      for (const vec3& p : gi.read(Buffer::Direct).pixels) ASSERT_EQ(maxComponent(p), 0) << size << ' ' << day;
    }
}

} // namespace lambent::test::soft_light_test
